// SPDX-License-Identifier: BSD-3-Clause
// Parameters of section [nav].
#include <headway/nav/predictive_obstacles_params.h>

namespace headway::nav {

const std::vector<std::pair<std::string, ObstaclePolicy>>& obstaclePolicies() {
  static const std::vector<std::pair<std::string, ObstaclePolicy>> policies = {
      {"static", ObstaclePolicy::kStatic},
      {"sweep", ObstaclePolicy::kSweep},
      {"time_gated", ObstaclePolicy::kTimeGated}};
  return policies;
}

void RobotMotionParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("robot_radius_m", radius_m, 0.05, 5.0, "m",
           "Radius of the circle about the robot's origin that holds it");
  user.add("robot_length_m", length_m, 0.0, 10.0, "m", "Length of the robot, about its origin");
  user.add("robot_width_m", width_m, 0.0, 10.0, "m", "Width of the robot");
  user.add("robot_max_speed_mps", max_speed_mps, 0.05, 30.0, "m/s", "The robot's maximum speed");
  section.add("robot_slow_ratio", slow_ratio, 0.05, 1.0, "",
              "Lowest speed assumed on the way to a place, relative to the maximum speed");
  section.add("early_slack_s", early_slack_s, 0.0, 5.0, "s",
              "Time by which the robot may reach a place earlier");
  section.add("late_slack_s", late_slack_s, 0.0, 5.0, "s",
              "Time by which the robot may reach a place later");
}

void GovernorParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("govern_speed", enabled, "Slow the robot where that avoids contacts");
  user.add("contact_margin_m", margin_m, 0.0, 2.0, "m", "Distance below which there is contact");
  user.add("robot_lag_s", lag_s, 0.0, 5.0, "s", "Time constant of the robot's speed control");
  section.add("govern_horizon_s", horizon_s, 0.2, 10.0, "s", "Horizon of the speed governor");
  section.add("contact_cost", contact_cost, 0.0, 1000.0, "",
              "Cost of a certain contact, relative to that of standing now");
  section.add("standing_ratio", standing_ratio, 0.0, 1.0, "",
              "Ratio of that cost for a contact with the standing robot");
  section.add("patience_s", patience_s, 0.1, 100.0, "s",
              "Decay time of a contact's cost with the time until it");
}

void PredictiveObstaclesParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("policy", policy, obstaclePolicies(),
           "Obstacles made of moving objects: their present points (static), everywhere they may "
           "be within the horizon (sweep), or only where they may meet the robot (time_gated)");
  user.add("horizon_s", horizon_s, 0.1, 10.0, "s", "Horizon of the predictions that are used");
  user.add("max_age_s", max_age_s, 0.05, 60.0, "s",
           "Age of the map from which sensing fails, so that the robot stops");
  section.add("map_frame", map_frame, "Name of the map's frame, in which the robot is asked for");
  section.add(
      "odom_frame", odom_frame,
      "Name of headway's odometry frame, in which a robot's pose may be, too; empty: in none. "
      "It is not that of the wheels");
  section.add("steer_horizon_s", steer_horizon_s, 0.1, 10.0, "s",
              "time_gated: horizon of obstacles; later contacts only slow the robot");
  section.add("min_probability", min_probability, 0.0, 1.0, "",
              "Minimum probability of a predicted path");
  section.add("sigmas", sigmas, 0.0, 5.0, "",
              "Standard deviations of its position by which an outline grows");
  section.add("max_growth_m", max_growth_m, 0.0, 5.0, "m", "Maximum growth of an outline");
  section.add("object_margin_m", object_margin_m, 0.0, 2.0, "m",
              "Distance from a moving object within which sensed points belong to it");
  section.add("place_spacing_m", place_spacing_m, 0.05, 2.0, "m",
              "Distance between predicted positions of one object");
  section.add("outline_spacing_m", outline_spacing_m, 0.05, 2.0, "m",
              "Distance between points of one outline");
  section.add("layer_spacing_m", layer_spacing_m, 0.1, 10.0, "m",
              "Distance between the heights at which an outline has points");
  section.add("use_static_grid", use_static_grid,
              "Occupied cells of the map's grid are obstacles, too");
  section.add("max_range_m", max_range_m, 1.0, 200.0, "m", "Maximum distance from the robot");
  robot.describe(section);
  governor.describe(section);
}

}  // namespace headway::nav
