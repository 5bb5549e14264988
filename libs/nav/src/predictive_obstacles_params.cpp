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
  section.add("robot_radius_m", radius_m, 0.05, 5.0, "m",
              "Radius about the robot's origin that holds its whole body");
  section.add("robot_length_m", length_m, 0.0, 10.0, "m", "Length of its body about the origin");
  section.add("robot_width_m", width_m, 0.0, 10.0, "m", "Width of its body");
  section.add("robot_top_speed", top_speed, 0.05, 30.0, "m/s", "The robot's top speed");
  section.add("robot_slow_share", slow_share, 0.05, 1.0, "-",
              "Slowest way to a place that is assumed, as a share of the top speed");
  section.add("early_slack_s", early_slack_s, 0.0, 5.0, "s",
              "The robot may be at a place earlier by this");
  section.add("late_slack_s", late_slack_s, 0.0, 5.0, "s",
              "The robot may be at a place later by this");
}

void GovernorParams::describe(Params::Section section) {
  section.add("govern_speed", enabled, "Slow the robot's commands where that spares contacts");
  section.add("govern_horizon_s", horizon_s, 0.2, 10.0, "s", "The governor looks so far ahead");
  section.add("contact_cost", contact_cost, 0.0, 1000.0, "-",
              "Cost of a certain contact, where standing for now costs 1");
  section.add("standing_share", standing_share, 0.0, 1.0, "-",
              "Share of that cost if the robot stands by then");
  section.add("patience_s", patience_s, 0.1, 100.0, "s",
              "Contacts so far ahead count a third: there is time to decide again");
  section.add("contact_margin_m", margin_m, 0.0, 2.0, "m", "What is nearer counts as a contact");
  section.add("robot_lag_s", lag_s, 0.0, 5.0, "s", "Time constant with which the robot obeys");
}

void PredictiveObstaclesParams::describe(Params::Section section) {
  section.add(
      "policy", policy, obstaclePolicies(),
      "Obstacles of what moves: points of now, the whole sweep, or the sweep gated by time");
  section.add("max_age_s", max_age_s, 0.05, 60.0, "s", "An older map is unsafe: sensing fails");
  section.add("map_frame", map_frame, "Name of the frame in which robot and map must be");
  section.add("horizon_s", horizon_s, 0.1, 10.0, "s", "How far ahead predictions are believed");
  section.add("steer_horizon_s", steer_horizon_s, 0.1, 10.0, "s",
              "time_gated: places farther ahead are no obstacles; they only slow the robot");
  section.add("min_probability", min_probability, 0.0, 1.0, "-",
              "Less probable predicted paths are left out");
  section.add("sigmas", sigmas, 0.0, 5.0, "-",
              "Bodies grow by so many standard deviations of their place");
  section.add("max_growth_m", max_growth_m, 0.0, 5.0, "m", "Bodies do not grow by more");
  section.add("body_margin_m", body_margin_m, 0.0, 2.0, "m",
              "Sensed points so near to a moving body are taken for that body");
  section.add("place_spacing_m", place_spacing_m, 0.05, 2.0, "m",
              "Spacing of the predicted places of one body");
  section.add("outline_spacing_m", outline_spacing_m, 0.05, 2.0, "m",
              "Spacing of the points of one outline");
  section.add("layer_spacing_m", layer_spacing_m, 0.1, 10.0, "m",
              "Spacing of the heights at which an outline has points");
  section.add("max_range_m", max_range_m, 1.0, 200.0, "m",
              "Places farther from the robot are left out");
  robot.describe(section);
  governor.describe(section);
}

}  // namespace headway::nav
