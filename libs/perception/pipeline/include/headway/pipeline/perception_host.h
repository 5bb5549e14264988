// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/log.h>
#include <headway/core/track.h>
#include <headway/map/perception_map.h>
#include <headway/slam/stereo_slam.h>

#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace headway::pipeline {

/// Calls to the host program, in the thread that calls Perception::process(), and before it
/// returns. Each may be empty. They must not call the Perception; an exception ends process().
struct PerceptionCallbacks {
  /// After localisation, before objects are detected: pose and covariance of the frame at a time,
  /// or that the camera is lost.
  std::function<void(Time, const slam::SlamUpdate&)> on_pose;
  /// After tracking: tracks of the frame with predictions.
  std::function<void(Time, const std::vector<Track>&)> on_tracks;
  /// After keyframes, landmarks, grid or dense points have changed: the map, which is cheap to
  /// copy.
  std::function<void(const map::PerceptionMap&)> on_map;
};

/// Parameters that may change at run time, between two frames. All others are fixed.
struct RuntimeParams {
  int detect_every_nth_frame = 1;   ///< detect.every_nth_frame, >= 1
  int grid_every_nth_frame = 3;     ///< grid.every_nth_frame, >= 0; 0 pauses the grid
  double recorded_timeout_s = 2.0;  ///< detect.recorded_timeout_s, > 0 [s]
  /// Distance beyond which boxes are not tracked, but counted as "load_shed", > 0 [m].
  double max_box_range_m = std::numeric_limits<double>::infinity();
};

}  // namespace headway::pipeline
