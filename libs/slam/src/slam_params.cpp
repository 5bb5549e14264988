#include <headway/slam/slam_params.h>

namespace headway::slam {

void SlamParams::describe(Params::Section section) {
  section.add("dynamic_rejection", dynamic_rejection,
              {{"none", DynamicRejection::kNone},
               {"boxes", DynamicRejection::kBoxes},
               {"geometric", DynamicRejection::kGeometric},
               {"both", DynamicRejection::kBoth}},
              "Features that count as moving: those in moving boxes, those whose own motion "
              "contradicts the camera's, or both");
  section.add("mapping", mapping, "Extend the map; false localises in the map as it is");
  section.add("use_odometry", use_odometry, "Predict the next pose by wheel odometry");
  section.add("use_imu", use_imu, "Predict the next turn by the gyroscope, level by gravity");
  section.add("features", features, 50, 3000, "", "Landmarks measured in each frame");
  section.add("min_zncc", min_zncc, 0.3, 0.99, "", "Correlation for a patch to count as found");
  section.add("sigma_px", sigma_px, 0.05, 5.0, "px", "Noise of a landmark's image position");
  section.add("sigma_disparity_px", sigma_disparity_px, 0.05, 5.0, "px", "Noise of a disparity");
  section.add("max_disparity_share", max_disparity_share, 0.05, 0.9, "of image width",
              "Largest disparity searched");
  section.add("min_inliers", min_inliers, 6, 200, "", "Landmarks that a pose must rest on");
  section.add("keyframe_overlap", keyframe_overlap, 0.1, 1.0, "",
              "A smaller share of the last keyframe's landmarks in view asks for a new keyframe");
  section.add("keyframe_flow", keyframe_flow, 0.005, 1.0, "of image width",
              "A greater median image motion since the last keyframe asks for a new one");
  section.add("window", window, 2, 50, "", "Keyframes adjusted together");
  section.add("ba_iterations", ba_iterations, 1, 100, "", "Steps of the bundle adjustment");
  section.add("loop_closing", loop_closing, "Recognise places seen before, correct the map");
  section.add("restart_after", restart_after, 1, 100000, "frames",
              "Lost frames after which a new part of the map is begun");
}

}  // namespace headway::slam
