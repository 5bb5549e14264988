// What a run leaves: the parts of Replay that are called at its end.
#include <headway/map/map_export.h>
#include <headway/map/map_file.h>
#include <headway/map/static_grid.h>
#include <headway/program/truth_report.h>

#include <algorithm>

#include "replay.h"

namespace headway::replay {

void Replay::countLostFrames(const std::vector<slam::FrameEstimate>& trajectory) {
  if (trajectory.empty()) return;
  std::size_t next = trajectory.front().frame;
  for (const auto& estimate : trajectory) {
    auto& missing = source_->dropsLateFrames() ? summary_.late_frames : summary_.lost_frames;
    while (next < estimate.frame) missing.push_back(next++);
    if (!estimate.tracked) summary_.lost_frames.push_back(estimate.frame);
    if (estimate.tracked) ++summary_.frames_tracked;
    ++next;
  }
  summary_.frames = next - trajectory.front().frame;
}

namespace {

std::string titleOf(const std::filesystem::path& folder) {
  return std::filesystem::weakly_canonical(folder).filename().string();
}

}  // namespace

void Replay::finish() {
  perception_->finish();
  const auto trajectory = perception_->trajectory();
  std::exception_ptr failure;  // the first failure; the other files are written nevertheless
  const auto attempt = [&failure](const auto& step) {
    try {
      step();
    } catch (...) {
      if (!failure) failure = std::current_exception();
    }
  };
  attempt([&] {
    writers_.writeSmoothed(perception_->flush());
    writers_.finish();
  });
  attempt([&] {
    writeTrajectories(folder_.path(), trajectory,
                      camera_ != nullptr ? camera_->T_robot_cam : robotFromOptical());
  });
  attempt([&] { writeMap(trajectory); });
  warnIfNotRelocalised(trajectory);
  attempt([&] { snapshots_.finish(*perception_); });
  attempt([&] {
    summarise(trajectory);
    writeSummary(folder_.path() / "summary.json", summary_);
  });
  if (!failure) {  // the report is made from the written files
    attempt([&] {
      program::writeTruthReport(folder_.path(), options_.truth, {}, titleOf(folder_.published()),
                                [this](const std::string& text) { warn(text); });
    });
  }
  if (failure) std::rethrow_exception(failure);
}

void Replay::summarise(const std::vector<slam::FrameEstimate>& trajectory) {
  countLostFrames(trajectory);
  const auto static_map = perception_->map().staticMap();
  summary_.keyframes = static_map->keyframes.size();
  summary_.landmarks = static_map->landmarks.size();
  summary_.tracks_confirmed = seen_tracks_.size();
  for (const auto& [id, moving] : seen_tracks_) summary_.tracks_moving += moving ? 1 : 0;
  summary_.stages.merge(perception_->times());
  summary_.laser = perception_->laserCounts();
  summary_.observations_skipped = source_->skipped();
  summary_.total_s = secondsSinceProcessStart();
}

void Replay::writeMap(const std::vector<slam::FrameEstimate>& trajectory) {
  if (trajectory.empty()) return;
  map::StoredMap stored = perception_->stored();
  stored.configuration = configuration_;
  if (const auto grid = stored.map.staticGrid())
    map::writeStaticGrid(folder_.path() / "map_grid", *grid);
  map::writeSimpleMap(folder_.path() / "map.simplemap", *stored.map.staticMap());
  map::writePly(folder_.path() / "map_points.ply", *stored.map.staticMap());
  map::saveMap(folder_.path() / "map.headway", std::move(stored));
}

void Replay::warnIfNotRelocalised(const std::vector<slam::FrameEstimate>& trajectory) const {
  const auto tracked = [](const slam::FrameEstimate& estimate) { return estimate.tracked; };
  if (options_.load_map.empty() || std::any_of(trajectory.begin(), trajectory.end(), tracked)) {
    return;
  }
  warn("no frame was re-localised in " + options_.load_map +
       ", which may be a map of another place; its landmarks and keyframes are unchanged");
}

}  // namespace headway::replay
