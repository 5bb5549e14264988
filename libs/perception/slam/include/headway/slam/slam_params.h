// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the SLAM, section [slam] of a configuration.
#pragma once

#include <headway/core/params.h>
#include <headway/core/worker_thread.h>

#include <cstddef>

namespace headway::slam {

/// Which features count as moving and stay out of pose and map.
enum class DynamicRejection {
  kNone,       ///< none: robust estimation alone
  kBoxes,      ///< those inside the moving regions handed to process()
  kGeometric,  ///< those whose motion in stereo contradicts the camera's
  kBoth,       ///< either
};

/// Parameters of the stereo SLAM, section [slam] of a configuration; ranges in describe().
struct SlamParams {
  DynamicRejection dynamic_rejection = DynamicRejection::kBoth;
  bool mapping = true;          ///< false: localise only, the map stays as it is
  bool use_odometry = true;     ///< wheel odometry predicts the next pose and joins keyframes
  bool use_imu = true;          ///< gyroscope predicts the next turn, gravity levels the map
  double max_speed_mps = 70.0;  ///< of the robot [m/s]; beyond it a pose cannot be right

  int features = 600;                ///< landmarks measured in each frame
  double min_zncc = 0.7;             ///< correlation of a matched patch [-]
  double sigma_px = 0.5;             ///< image noise of one measurement [px]
  double sigma_disparity_px = 0.4;   ///< [px]
  double max_disparity_ratio = 0.3;  ///< maximum disparity searched [ratio of the image width]
  int min_inliers = 20;              ///< of a pose

  double keyframe_overlap = 0.7;      ///< min. ratio of the last keyframe's landmarks in view [-]
  double keyframe_flow_ratio = 0.06;  ///< max. median image motion since it [ratio of the width]
  int window = 24;                    ///< keyframes in local bundle adjustment
  int max_ba_iterations = 6;          ///< of local bundle adjustment
  bool loop_closing = true;           ///< recognise places seen before and correct the map
  double restart_after_s = 2.0;       ///< camera lost before a new submap is initialised [s]

  /// Runs bundle adjustment, the search for loops and the pose graph in threads of their own, so
  /// that results depend on timing. Not a key of configurations: live operation sets it.
  bool adjust_in_background = false;

  /// Frames of the trajectory in memory; older ones are in a temporary file (see TemporaryFile).
  /// Not a key of configurations, because no result depends on it.
  std::size_t trajectory_in_memory = 10000;

  /// Ends adjustments of the map early, with the solution so far or none, as at the end of a
  /// program. Not a key of configurations.
  StopCondition stop = neverStop;

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "slam"); }  ///< @throws InputError
};

}  // namespace headway::slam
