// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>
#include <headway/core/random.h>
#include <headway/sim/sim_params.h>

#include <vector>

#include "driving.h"
#include "navigation_grid.h"
#include "suspension.h"

namespace headway::sim {

/// A robot with two driven wheels: drives straight from corner to corner of its way, turns on the
/// spot, brakes hard before people and now and then without cause, nods as it brakes, and bumps
/// over thresholds.
class WheeledRobot {
 public:
  /// Half of its width, with what its wheels need [m].
  static constexpr double kRadius = 0.32;

  /// Site and grid must outlive the object.
  WheeledRobot(const SimParams& params, const Site& site, const NavigationGrid& grid,
               std::uint64_t seed);

  void advance(double dt, const std::vector<Obstacle>& others);

  /// Robot frame (on the ground below the cameras) in the world.
  [[nodiscard]] Pose T_world_robot() const;
  /// What others see of it.
  [[nodiscard]] Obstacle obstacle() const;
  [[nodiscard]] Eigen::Vector2d position() const { return position_; }
  /// A place on its way, up to so far ahead.
  [[nodiscard]] Eigen::Vector2d ahead(double distance) const;

 private:
  void chooseStop();
  /// Speed and turn rate that the way demands.
  struct Command {
    double speed = 0.0;      ///< [m/s]
    double turn_rate = 0.0;  ///< [rad/s]
  };
  [[nodiscard]] Command command(double dt);
  [[nodiscard]] Command drive(double distance, double turn) const;
  [[nodiscard]] bool mustStop(const std::vector<Obstacle>& others) const;

  RouteParams route_;
  RobotParams params_;
  double ride_rad_;
  const Site& site_;
  const NavigationGrid& grid_;
  Random random_;
  Eigen::Vector2d position_;
  double yaw_ = 0.0, speed_ = 0.0, turn_rate_ = 0.0;
  std::vector<Eigen::Vector2d> way_;  ///< corners still ahead
  double pause_s_ = 0.5;              ///< left of standing at a stop
  double sudden_stop_s_ = 0.0;        ///< left of a stop without cause
  double blocked_s_ = 0.0;            ///< time that somebody has been in the way
  bool turning_ = false;              ///< on the spot
  Suspension pitch_, roll_;
};

}  // namespace headway::sim
