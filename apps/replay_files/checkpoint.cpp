// SPDX-License-Identifier: BSD-3-Clause
#include "checkpoint.h"

#include <headway/core/output_file.h>
#include <headway/map/map_export.h>

#include <exception>
#include <utility>

#include "frame_writers.h"

namespace headway::replay {
namespace {

void writeTrajectory(const std::filesystem::path& folder, const CheckpointContents& contents) {
  TrajectoryWriter writer(folder, contents.T_robot_cam);
  contents.trajectory([&](const slam::FrameEstimate& estimate) { writer.add(estimate); });
  writer.commit();
}

void writeContents(const std::filesystem::path& folder, CheckpointContents contents) {
  for (const auto& log : contents.logs) synchroniseFile(log);
  writeTrajectory(folder, contents);
  map::writePly(folder / "map_points.ply", *contents.map.map.staticMap());
  map::saveMap(folder / "map.headway", std::move(contents.map));
  writeSummary(folder / "summary.json", contents.summary);
}

}  // namespace

void describeCheckpoints(double& interval_s, Params& params) {
  params.section("output").add(
      "checkpoint_s", interval_s, 0.0, 3600.0, "s",
      "Time between checkpoints of map and trajectory, which a killed run leaves; 0: none");
}

Checkpoint::Checkpoint(std::filesystem::path folder, double interval_s,
                       std::function<CheckpointContents()> collect,
                       std::function<void(const std::string&)> warn)
    : folder_(std::move(folder)),
      interval_(interval_s),
      collect_(std::move(collect)),
      warn_(std::move(warn)),
      last_(std::chrono::steady_clock::now()) {}

bool Checkpoint::isDue() const {
  constexpr double kMinRatio = 50.0;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - last_;
  const bool is_early = elapsed < interval_ || elapsed < kMinRatio * collecting_;
  if (interval_.count() <= 0.0 || is_early) return false;
  return !writing_.valid() ||
         writing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

void Checkpoint::onFrame(const run::FrameResult& /*result*/, pipeline::Perception& /*perception*/) {
  if (!isDue()) return;
  finish();
  const auto start = std::chrono::steady_clock::now();
  auto contents = collect_();
  last_ = std::chrono::steady_clock::now();
  collecting_ = last_ - start;
  writing_ =
      std::async(std::launch::async, [folder = folder_, what = std::move(contents)]() mutable {
        writeContents(folder, std::move(what));
      });
}

void Checkpoint::onEnd(const std::optional<std::string>& /*failure*/) { finish(); }

void Checkpoint::finish() {
  if (!writing_.valid()) return;
  try {
    writing_.get();
  } catch (const std::exception& error) {
    warn_(std::string("no checkpoint: ") + error.what());
  }
}

}  // namespace headway::replay
