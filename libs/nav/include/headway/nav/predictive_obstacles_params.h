#pragma once

#include <headway/core/params.h>

#include <string>
#include <utility>
#include <vector>

namespace headway::nav {

/// What a planner is told of the things that move.
enum class ObstaclePolicy {
  kStatic,     ///< where the robot's own sensors see them now: the map is not asked
  kSweep,      ///< that, and wherever they may be within the horizon
  kTimeGated,  ///< only where they may be when the robot could be there
};

/// "static", "sweep" and "time_gated", as command lines and files spell them.
[[nodiscard]] const std::vector<std::pair<std::string, ObstaclePolicy>>& obstaclePolicies();

/// The robot as the time gate sees it: a disc that drives at a range of speeds.
struct RobotMotionParams {
  double radius_m = 0.35;  ///< of the smallest circle about the robot's origin that holds it [m]
  double length_m = 0.5;   ///< of its body about the origin [m]
  double width_m = 0.45;   ///< [m]
  double max_speed_mps = 1.0;  ///< [m/s]
  double slow_ratio = 0.8;  ///< slowest speed assumed on the way to a place, over max_speed_mps [-]
  double early_slack_s = 0.0;  ///< the robot may be earlier by this [s]
  double late_slack_s = 0.3;   ///< the robot may be later by this, having to speed up first [s]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "nav"); }  ///< @throws InputError
};

/// How the robot's speed is governed among what moves.
struct GovernorParams {
  bool enabled = true;
  double horizon_s = 2.5;       ///< looks so far ahead [s]
  double contact_cost = 40.0;   ///< of a certain contact, where standing for now costs 1 [-]
  double standing_ratio = 0.5;  ///< ratio of that cost if the robot stands by then [-]
  double patience_s = 2.0;      ///< what is so far ahead counts a third [s]
  double margin_m = 0.1;        ///< nearer than this is a contact [m]
  double lag_s = 0.15;          ///< time constant with which the robot obeys [s]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "nav"); }  ///< @throws InputError
};

/// How tracks become obstacles, section "nav".
struct PredictiveObstaclesParams {
  ObstaclePolicy policy = ObstaclePolicy::kTimeGated;
  double max_age_s = 0.5;         ///< an older map is unsafe [s]
  std::string map_frame = "map";  ///< name of the frame in which robot and map must be
  double horizon_s = 3.0;         ///< how far ahead predictions are believed [s]
  double steer_horizon_s = 1.5;   ///< kTimeGated: later places do not steer, they slow [s]
  double min_probability = 0.1;   ///< less probable paths are left out [-]
  double sigmas = 1.0;            ///< bodies grow by so many standard deviations of their place [-]
  double max_growth_m = 0.4;      ///< but not by more [m]
  double body_margin_m = 0.25;    ///< sensed points so near to a body are that body [m]
  double place_spacing_m = 0.25;  ///< between predicted places of one body [m]
  double outline_spacing_m = 0.2;  ///< between points of one outline [m]
  double layer_spacing_m = 0.6;    ///< between the heights of points: 3D robots have sections [m]
  double max_range_m = 12.0;       ///< places farther from the robot are left out [m]
  RobotMotionParams robot;
  GovernorParams governor;

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "nav"); }  ///< @throws InputError
};

}  // namespace headway::nav
