// SPDX-License-Identifier: BSD-3-Clause
// Common parts of the benchmarks of slam: command line and evaluation of a path.
#pragma once

#include <headway/eval/trajectory_error.h>
#include <headway/io/rawlog_source.h>
#include <headway/pipeline/perception.h>
#include <headway/program/command_line.h>

#include <optional>
#include <string>
#include <vector>

namespace headway {

/// A command line with the pipeline's parameters; detectors are off unless requested.
struct SlamBenchLine {
  SlamBenchLine(const std::string& program, const std::string& summary) : line(program, summary) {
    settings.detection.detector = "none";
    settings.describe(params);
    line.parameters(params);
  }
  SlamBenchLine(const SlamBenchLine&) = delete;
  SlamBenchLine& operator=(const SlamBenchLine&) = delete;

  pipeline::PerceptionParams settings;
  Params params;
  program::CommandLine line;
};

/// Of the tracked frames, rigidly aligned; nullopt where there are too few, or no truth.
inline std::optional<eval::TrajectoryError> errorOf(
    const std::vector<slam::FrameEstimate>& trajectory, const std::vector<Stamped<Pose>>& truth) {
  std::vector<Stamped<Pose>> path;
  for (const auto& estimate : trajectory) {
    if (estimate.tracked) path.push_back({estimate.time, estimate.T_map_robot});
  }
  constexpr std::size_t kFewest = 3;  // that can be aligned
  if (truth.size() < kFewest || path.size() < kFewest) return std::nullopt;
  return eval::trajectoryError(eval::pairByTime(truth, path, 0.02), {});
}

}  // namespace headway
