// SPDX-License-Identifier: BSD-3-Clause
#include <headway/detect/stereo_motion.h>

namespace headway::detect {
namespace {

void describeExpertKeys(StereoMotionParams& params, Params::Section& section) {
  section.add("max_points", params.max_points, 100, 10000, "", "Maximum points tracked at a time");
  section.add("spacing_px", params.spacing_px, 4, 64, "px", "Distance between tracked points");
  section.add("window_s", params.window_s, 0.1, 3.0, "s", "Time window of a point's observations");
  section.add("segment_window_s", params.segment_window_s, 0.1, 3.0, "s",
              "Time window of a segment's observations");
  section.add("max_height_m", params.max_height_m, 0.5, 20.0, "m",
              "Maximum height above ground of points on objects");
  section.add("sigma_px", params.sigma_px, 0.05, 5.0, "px", "Noise of a point's image position");
  section.add("sigma_disparity_px", params.sigma_disparity_px, 0.05, 5.0, "px",
              "Noise of a point's disparity");
  section.add("significance", params.significance, 5.0, 1000.0, "",
              "Threshold of a point's motion test, chi-square of 3 degrees of freedom");
  section.add("max_speed_mps", params.max_speed_mps, 1.0, 200.0, "m/s", "Maximum object speed");
  section.add("min_points", params.min_points, 2, 50, "", "Minimum points of an object");
  section.add("max_point_distance_m", params.max_point_distance_m, 0.1, 10.0, "m",
              "Maximum ground distance between neighbouring points of one object");
  section.add("min_moving_ratio", params.min_moving_ratio, 0.0, 1.0, "",
              "Minimum ratio of moving points within an object's outline");
  section.add("max_segment_range_m", params.max_segment_range_m, 0.0, 100.0, "m",
              "Maximum distance at which upright segments are tracked as a whole; 0: derived "
              "from the rig");
  section.add("segment_significance", params.segment_significance, 5.0, 1000.0, "",
              "Threshold of a segment's motion test, chi-square of 2 degrees of freedom");
  section.add("max_moving_ratio", params.max_moving_ratio, 0.1, 1.0, "",
              "Ratio of moving points above which the camera's motion is rejected as wrong");
}

}  // namespace

void StereoMotionParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("max_range_m", max_range_m, 0.0, 200.0, "m",
           "Maximum distance of moving objects; 0: derived from the rig");
  user.add("min_height_m", min_height_m, 0.0, 5.0, "m",
           "Minimum height above ground of points on objects, greater on rough ground; 0: two "
           "thirds of the "
           "rig's minimum obstacle height");
  user.add("min_speed_mps", min_speed_mps, 0.05, 20.0, "m/s",
           "Speed below which an object is static; smaller finds slower people and more false "
           "objects");
  user.add("classify", classify,
           "Classify objects by size and speed; false reports every object as Unknown");
  describeExpertKeys(*this, section);
}

}  // namespace headway::detect
