#include "trial_params.h"

#include <cmath>

namespace headway::app {

double RobotParams::radius() const { return 0.5 * std::hypot(length_m, width_m); }

void RobotParams::describe(Params::Section section) {
  section.add("length_m", length_m, 0.1, 5.0, "m", "Length of the robot's body");
  section.add("width_m", width_m, 0.1, 5.0, "m", "Width of the robot's body");
  section.add("margin_m", margin_m, 0.0, 1.0, "m", "Margin that the navigator keeps about it");
  section.add("top_speed", top_speed, 0.1, 5.0, "m/s", "Top speed");
  section.add("top_turn_dps", top_turn_dps, 5.0, 720.0, "deg/s", "Top turn rate");
  section.add("lag_s", lag_s, 0.0, 5.0, "s", "Time constant with which the wheels obey");
  section.add("goal_m", goal_m, 1.0, 100.0, "m", "Goal, straight ahead of the start");
  section.add("planning_rate_hz", planning_rate_hz, 1.0, 100.0, "Hz", "Steps of the navigator");
  section.add("planning_reach_m", planning_reach_m, 1.0, 50.0, "m",
              "How far the navigator looks; where it slows down scales with it");
  section.add("time_limit_s", time_limit_s, 1.0, 1000.0, "s",
              "A goal that is reached later is not reached");
}

void SensorParams::describe(Params::Section section) {
  section.add("scan_range_m", scan_range_m, 0.5, 100.0, "m", "Range of the scanner");
  section.add("scan_sigma_m", scan_sigma_m, 0.0, 1.0, "m", "Noise of the scanner");
  section.add("detection_rate_hz", detection_rate_hz, 1.0, 50.0, "Hz", "Rate of the detector");
  section.add("detection_range_m", detection_range_m, 1.0, 100.0, "m", "Range of the detector");
  section.add("field_of_view_deg", field_of_view_deg, 10.0, 360.0, "deg",
              "Field of view of the detector, about straight ahead; the scanner sees all round");
  section.add("along_sigma_m", along_sigma_m, 0.0, 2.0, "m",
              "Noise of a detected place along the ray");
  section.add("along_sigma_per_m", along_sigma_per_m, 0.0, 1.0, "m/m",
              "Growth of that noise with distance");
  section.add("across_share", across_share, 0.0, 2.0, "-",
              "Noise across the ray, as a share of that along it");
  section.add("size_sigma_m", size_sigma_m, 0.0, 1.0, "m",
              "Noise of a detected width; length and height in proportion");
  section.add("yaw_sigma_deg", yaw_sigma_deg, 0.0, 90.0, "deg", "Noise of a detected heading");
  section.add("flip_share", flip_share, 0.0, 1.0, "-", "Detected headings that are turned round");
  section.add("miss_share", miss_share, 0.0, 1.0, "-", "People not detected in a frame");
  section.add("double_share", double_share, 0.0, 1.0, "-", "People detected twice in a frame");
  section.add("false_share", false_share, 0.0, 1.0, "-", "Frames with a detection of nobody");
}

void TrialParams::describe(Params& params) {
  robot.describe(params.section("robot").user());
  people.describe(params.section("people").user());
  sensors.describe(params.section("sensors").user());
}

}  // namespace headway::app
