// SPDX-License-Identifier: BSD-3-Clause
#include "trial_params.h"

#include <cmath>

namespace headway::app {

double RobotParams::radius() const { return 0.5 * std::hypot(length_m, width_m); }

void RobotParams::describe(Params::Section section) {
  section.add("length_m", length_m, 0.1, 5.0, "m", "Length of the robot");
  section.add("width_m", width_m, 0.1, 5.0, "m", "Width of the robot");
  section.add("margin_m", margin_m, 0.0, 1.0, "m",
              "Margin that the navigator adds around the robot");
  section.add("max_speed_mps", max_speed_mps, 0.1, 5.0, "m/s", "Maximum speed");
  section.add("max_turn_dps", max_turn_dps, 5.0, 720.0, "deg/s", "Maximum turn rate");
  section.add("lag_s", lag_s, 0.0, 5.0, "s", "Time constant of the wheels' speed control");
  section.add("goal_m", goal_m, 1.0, 100.0, "m",
              "Distance of the goal, straight ahead of the start");
  section.add("planning_rate_hz", planning_rate_hz, 1.0, 100.0, "Hz",
              "Planning rate of the navigator");
  section.add("planning_reach_m", planning_reach_m, 1.0, 50.0, "m",
              "Planning distance of the navigator; its braking distance scales with it");
  section.add("time_limit_s", time_limit_s, 1.0, 1000.0, "s", "Duration of a trial");
}

void SensorParams::describe(Params::Section section) {
  section.add("scan_range_m", scan_range_m, 0.5, 100.0, "m", "Range of the scanner");
  section.add("scan_sigma_m", scan_sigma_m, 0.0, 1.0, "m", "Noise of the scanner");
  section.add("detection_rate_hz", detection_rate_hz, 1.0, 50.0, "Hz", "Rate of the detector");
  section.add("detection_range_m", detection_range_m, 1.0, 100.0, "m", "Range of the detector");
  section.add(
      "field_of_view_deg", field_of_view_deg, 10.0, 360.0, "deg",
      "Field of view of the detector, centred straight ahead; the scanner covers 360 degrees");
  section.add("along_sigma_m", along_sigma_m, 0.0, 2.0, "m",
              "Noise of a detected position along the ray");
  section.add("along_sigma_per_m", along_sigma_per_m, 0.0, 1.0, "m/m",
              "Growth of that noise with distance");
  section.add("across_ratio", across_ratio, 0.0, 2.0, "-",
              "Ratio of the noise across the ray to that along it");
  section.add("size_sigma_m", size_sigma_m, 0.0, 1.0, "m",
              "Noise of a detected width; length and height in proportion");
  section.add("yaw_sigma_deg", yaw_sigma_deg, 0.0, 90.0, "deg", "Noise of a detected heading");
  section.add("flip_probability", flip_probability, 0.0, 1.0, "-",
              "Probability that a detected heading is reversed");
  section.add("miss_probability", miss_probability, 0.0, 1.0, "-",
              "Probability that a person is not detected in a frame");
  section.add("duplicate_probability", duplicate_probability, 0.0, 1.0, "-",
              "Probability that a person is detected twice in a frame");
  section.add("false_alarm_probability", false_alarm_probability, 0.0, 1.0, "-",
              "Probability of a false alarm in a frame");
}

void TrialParams::describe(Params& params) {
  robot.describe(params.section("robot").user());
  people.describe(params.section("people").user());
  sensors.describe(params.section("sensors").user());
}

}  // namespace headway::app
