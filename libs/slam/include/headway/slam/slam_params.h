#pragma once

#include <headway/core/params.h>

namespace headway::slam {

/// Which features count as moving and stay out of pose and map.
enum class DynamicRejection {
  kNone,       ///< none: robust estimation alone
  kBoxes,      ///< those inside the moving regions handed to process()
  kGeometric,  ///< those whose motion in stereo contradicts the camera's
  kBoth,       ///< either
};

/// Parameters of the stereo SLAM, section [slam] of a configuration.
struct SlamParams {
  DynamicRejection dynamic_rejection = DynamicRejection::kBoth;
  bool mapping = true;       ///< false: localise only, the map stays as it is
  bool use_odometry = true;  ///< wheel odometry predicts the next pose where recorded
  bool use_imu = true;       ///< gyroscope predicts the next turn, gravity levels the map

  int features = 600;     ///< landmarks measured a frame, 50 ... 3000
  double min_zncc = 0.7;  ///< correlation that a patch needs to count as found, 0.3 ... 0.99
  double sigma_px = 0.5;  ///< [px] image noise of one measurement, 0.05 ... 5
  double sigma_disparity_px = 0.4;  ///< [px] noise of a measured disparity, 0.05 ... 5
  double max_disparity_share =
      0.3;               ///< largest disparity as share of the image width, 0.05 ... 0.9
  int min_inliers = 20;  ///< landmarks a pose must rest on, 6 ... 200

  double keyframe_overlap = 0.7;  ///< share of the last keyframe's landmarks that spares a new one
  double keyframe_flow = 0.06;    ///< median image motion (share of width) that asks for a new one
  int window = 8;                 ///< keyframes adjusted together, 2 ... 50
  int ba_iterations = 6;          ///< steps of the bundle adjustment, 1 ... 100
  bool loop_closing = true;       ///< recognise places seen before and correct the map
  int restart_after = 20;         ///< lost frames after which a new map part is begun, 1 ... 100000

  /// Bundle adjustment in a thread of its own, beside the tracking: results depend on timing. Not a
  /// key of configurations: who runs in real time sets it.
  bool adjust_in_background = false;

  void describe(Params::Section section);
};

}  // namespace headway::slam
