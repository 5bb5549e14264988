// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the SLAM, section [slam] of a configuration.
#include <headway/slam/slam_params.h>

namespace headway::slam {
namespace {

void describeExpertKeys(SlamParams& params, Params::Section& section) {
  section.add("min_zncc", params.min_zncc, 0.3, 0.99, "", "Minimum correlation of a matched patch");
  section.add("sigma_px", params.sigma_px, 0.05, 5.0, "px", "Noise of a landmark's image position");
  section.add("sigma_disparity_px", params.sigma_disparity_px, 0.05, 5.0, "px",
              "Noise of a disparity");
  section.add("max_disparity_ratio", params.max_disparity_ratio, 0.05, 0.9, "of image width",
              "Maximum disparity searched");
  section.add("min_inliers", params.min_inliers, 6, 200, "", "Minimum inlier landmarks of a pose");
  section.add("keyframe_overlap", params.keyframe_overlap, 0.1, 1.0, "",
              "Ratio of the last keyframe's landmarks in view below which a keyframe is made");
  section.add("keyframe_flow_ratio", params.keyframe_flow_ratio, 0.005, 1.0, "of image width",
              "Median image motion since the last keyframe above which a keyframe is made");
  section.add("window", params.window, 2, 50, "keyframes", "Keyframes in local bundle adjustment");
  section.add("max_ba_iterations", params.max_ba_iterations, 1, 100, "",
              "Maximum iterations of local bundle adjustment");
  section.add("max_speed", params.max_speed_mps, 1.0, 1000.0, "m/s",
              "Maximum speed of the robot; faster frames are unreliable, and a warning names the "
              "first one");
  section.add("restart_after_s", params.restart_after_s, 0.0, 10000.0, "s",
              "Time of a lost camera after which a new submap is initialised");
  section.renamed("restart_after_frames", "restart_after_s", secondsOfFrames);
}

}  // namespace

void SlamParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("dynamic_rejection", dynamic_rejection,
           {{"none", DynamicRejection::kNone},
            {"boxes", DynamicRejection::kBoxes},
            {"geometric", DynamicRejection::kGeometric},
            {"both", DynamicRejection::kBoth}},
           "Which features are excluded from pose and map as moving: those in boxes of moving "
           "objects, those whose motion contradicts the camera's, or both; none is faster in "
           "a static scene");
  user.add("mapping", mapping,
           "Extend the map; false localises in a loaded map without changing it");
  user.add(
      "use_odometry", use_odometry,
      "Predict the next pose by recorded wheel odometry and adjust the map to it; false if the "
      "wheels slip most of the time");
  user.add("use_imu", use_imu,
           "Predict the next rotation by the recorded gyroscope and level the map by gravity; "
           "false if the IMU is not calibrated to the camera");
  user.add("features", features, 50, 3000, "",
           "Landmarks measured in each frame; more are more accurate and slower");
  user.add("loop_closing", loop_closing,
           "Recognise places seen before and correct the map; false saves time on open paths");
  describeExpertKeys(*this, section);
}

}  // namespace headway::slam
