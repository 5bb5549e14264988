// SPDX-License-Identifier: BSD-3-Clause
// Parameters of section [nav].
#pragma once

#include <headway/core/params.h>

#include <string>
#include <utility>
#include <vector>

namespace headway::nav {

/// Which obstacles a planner receives of moving objects.
enum class ObstaclePolicy {
  kStatic,     ///< the robot's own sensor points only; the map is not read
  kSweep,      ///< and all predicted places within the horizon
  kTimeGated,  ///< and the predicted places that the robot could reach at that time
};

/// Names in command lines and files: "static", "sweep", "time_gated".
[[nodiscard]] const std::vector<std::pair<std::string, ObstaclePolicy>>& obstaclePolicies();

/// The robot as a disc with a range of speeds, and as a rectangle for contacts.
struct RobotMotionParams {
  double radius_m = 0.35;      ///< of the smallest circle about its origin that encloses it [m]
  double length_m = 0.5;       ///< centred at the origin [m]
  double width_m = 0.45;       ///< [m]
  double max_speed_mps = 1.0;  ///< forward [m/s]
  double slow_ratio = 0.8;     ///< lowest assumed speed over max_speed_mps [-]
  double early_slack_s = 0.0;  ///< by which the robot may be earlier [s]
  double late_slack_s = 0.3;   ///< by which it may be later, for acceleration [s]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "nav"); }  ///< @throws InputError
};

/// Speed governor among moving objects.
struct GovernorParams {
  bool enabled = true;
  double horizon_s = 2.5;       ///< of the predicted contacts [s]
  double contact_cost = 40.0;   ///< of a certain contact; stopping now costs 1 [-]
  double standing_ratio = 0.5;  ///< factor of that cost if the robot is at rest by then [-]
  double patience_s = 2.0;      ///< decay time of a contact's cost with the time until it [s]
  double margin_m = 0.1;        ///< distance below which there is contact [m]
  double lag_s = 0.15;          ///< time constant of the robot's speed control [s]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "nav"); }  ///< @throws InputError
};

/// Obstacles from tracks, section "nav".
struct PredictiveObstaclesParams {
  ObstaclePolicy policy = ObstaclePolicy::kTimeGated;
  double max_age_s = 0.5;         ///< of the map; sensing fails with an older one [s]
  std::string map_frame = "map";  ///< name of the map's frame, in which the robot is asked for
  /// Name of headway's odometry frame, in which a robot's pose may be, too; empty: in none. It is
  /// not that of the wheels.
  std::string odom_frame;
  double horizon_s = 3.0;          ///< of the predictions that are used [s]
  double steer_horizon_s = 1.5;    ///< kTimeGated: later contacts only slow the robot [s]
  double min_probability = 0.1;    ///< of a predicted path that is used [-]
  double sigmas = 1.0;             ///< of the position by which outlines grow [standard deviations]
  double max_growth_m = 0.4;       ///< limit of that growth [m]
  double object_margin_m = 0.25;   ///< sensed points within belong to the object [m]
  double place_spacing_m = 0.25;   ///< between predicted places of one object [m]
  double outline_spacing_m = 0.2;  ///< between points of one outline [m]
  double layer_spacing_m = 0.6;    ///< between the heights of points, for 3D robots [m]
  double max_range_m = 12.0;       ///< of places from the robot [m]
  bool use_static_grid = true;     ///< occupied cells of the map's grid are obstacles, too
  RobotMotionParams robot;
  GovernorParams governor;

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "nav"); }  ///< @throws InputError
};

}  // namespace headway::nav
