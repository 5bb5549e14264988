// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/params.h>
#include <headway/map/map_file.h>
#include <headway/run/session.h>
#include <headway/slam/map_view.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "summary.h"

namespace headway::replay {

/// Binds the time between two checkpoints [s] to section [output].
void describeCheckpoints(double& interval_s, Params& params);

/// What a checkpoint contains: the results so far that are not written frame by frame.
struct CheckpointContents {
  slam::TrajectoryVisit trajectory;
  Pose T_robot_cam = Pose::Identity();
  map::StoredMap map;
  Summary summary;
  std::vector<std::filesystem::path> logs;  ///< files of rows, to be synchronised with the disk
};

/// Writes map.headway, map_points.ply, trajectory.tum, trajectory_kitti.txt and summary.json while
/// a run goes on, in a thread of its own, so that a killed run leaves them.
class Checkpoint : public run::Sink {
 public:
  /// @param interval_s  time between two checkpoints; 0: none
  /// @param collect     what to write
  /// @param warn        called with the reason why a checkpoint could not be written
  Checkpoint(std::filesystem::path folder, double interval_s,
             std::function<CheckpointContents()> collect,
             std::function<void(const std::string&)> warn);

  void onFrame(const run::FrameResult& result, pipeline::Perception& perception) override;
  void onEnd(const std::optional<std::string>& failure) override;

 private:
  /// Whether the interval has passed, the last checkpoint is written, and collecting its contents
  /// took less than 2 % of the time since.
  [[nodiscard]] bool isDue() const;
  /// Waits for the end of writing.
  void finish();

  std::filesystem::path folder_;
  std::chrono::duration<double> interval_;
  std::function<CheckpointContents()> collect_;
  std::function<void(const std::string&)> warn_;
  std::chrono::steady_clock::time_point last_;
  std::chrono::duration<double> collecting_{0.0};  ///< duration of the last time
  std::future<void> writing_;
};

}  // namespace headway::replay
