// SPDX-License-Identifier: BSD-3-Clause
// What the map keeps while one way is driven again and again: a row of a table for each lap.
//
//     bench_memory -i IN.rawlog --lap METRES [--set slam.key=value ...]
//
// Laps are counted along the true path that the rawlog holds.

#include <headway/core/error.h>
#include <headway/core/statistics.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <map>

#include "slam_bench_line.h"

namespace {

using namespace headway;

double residentMb() {
  std::ifstream pages("/proc/self/statm");
  double total = 0.0;
  double resident = 0.0;
  pages >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

/// What one lap did.
struct Lap {
  std::size_t lost = 0;
  std::size_t keyframes_made = 0;
  std::size_t loops = 0;
  std::vector<double> frame_ms;
};

void printRow(std::size_t frames, const Lap& lap, const pipeline::Perception& perception) {
  const auto& static_map = *perception.map().staticMap();
  const double map_mb =
      static_cast<double>(collected(perception.stored().made_attachments.at("slam")).size()) / 1e6;
  std::printf("| %zu | %zu | %zu | %zu | %zu | %zu | %.1f | %.0f | %.1f | %.1f |\n", frames,
              lap.lost, lap.loops, lap.keyframes_made, static_map.keyframes.size(),
              static_map.landmarks.size(), map_mb, residentMb(), percentile(lap.frame_ms, 0.5),
              percentile(lap.frame_ms, 0.95));
  std::fflush(stdout);
}

/// True length of the path up to each time [m].
std::map<Time, double> pathLengths(const std::string& rawlog) {
  const auto truth = io::readTruth(rawlog).poses;
  if (truth.empty()) throw InputError(rawlog + ": holds no truth_pose to count laps by");
  std::map<Time, double> lengths;
  double length = 0.0;
  Eigen::Vector3d before = truth.front().value.translation();
  for (const auto& pose : truth) {
    length += (pose.value.translation() - before).norm();
    before = pose.value.translation();
    lengths[pose.time] = length;
  }
  return lengths;
}

int measure(int argc, const char* const* argv) {
  std::string input;
  double lap_m = 0.0;
  SlamBenchLine bench("bench_memory", "Shows what the map keeps, lap by lap.");
  bench.line.option(input, 'i', "input", "IN.rawlog", "rawlog with stereo images", true);
  bench.line.option(lap_m, 0, "lap", "METRES", "length of a lap, a row each");
  if (!bench.line.parse(argc, argv)) return program::kDone;
  if (!(lap_m > 0.0)) throw program::UsageError("--lap must be greater than 0");

  const auto lengths = pathLengths(input);
  io::RawlogSource source(input, {});
  pipeline::Perception perception(source.camera(), bench.settings);
  std::printf(
      "| frames | lost | loops | keyframes made | keyframes | landmarks | map MB | resident MB | "
      "frame ms | p95 |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  Lap lap;
  std::size_t frames = 0;
  int laps = 1;
  while (auto frame = source.next()) {
    StageTimes span;
    const auto watch = span.watch("frame");
    const auto update = perception.process(*frame);
    lap.frame_ms.push_back(watch.elapsedMs());
    lap.lost += update.camera.status == slam::TrackingStatus::kLost ? 1 : 0;
    lap.keyframes_made += update.camera.is_keyframe ? 1 : 0;
    for (const auto& loop : update.camera.loops) {
      lap.loops += loop.outcome == slam::LoopOutcome::kClosed ? 1 : 0;
    }
    ++frames;
    const auto length = lengths.upper_bound(frame->time);
    if (length != lengths.end() && length->second < laps * lap_m) continue;
    printRow(frames, lap, perception);
    lap = Lap{};
    ++laps;
  }
  return program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return headway::program::run("bench_memory", [&] { return measure(argc, argv); });
}
