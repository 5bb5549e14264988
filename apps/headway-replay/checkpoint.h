// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/params.h>
#include <headway/map/map_file.h>
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
class Checkpoint {
 public:
  /// @param interval_s  time between two checkpoints; 0: none
  Checkpoint(std::filesystem::path folder, double interval_s);
  ~Checkpoint();

  /// Whether the interval has passed, the last checkpoint is written, and collecting its contents
  /// took less than 2 % of the time since.
  [[nodiscard]] bool isDue() const;
  /// Starts to write what `collect` returns.
  void write(const std::function<CheckpointContents()>& collect);
  /// Waits for the end of writing. @return why the latest checkpoint could not be written
  std::optional<std::string> finish();

 private:
  std::filesystem::path folder_;
  std::chrono::duration<double> interval_;
  std::chrono::steady_clock::time_point last_;
  std::chrono::duration<double> collecting_{0.0};  ///< duration of the last time
  std::future<void> writing_;
};

}  // namespace headway::replay
