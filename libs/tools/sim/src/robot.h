// SPDX-License-Identifier: BSD-3-Clause
// The robot's motion: along a lane, or from stop to stop on a site.
#pragma once

#include <headway/core/pose.h>
#include <headway/core/random.h>
#include <headway/sim/driven_world.h>
#include <headway/sim/sim_params.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "driving.h"
#include "navigation_grid.h"
#include "vehicles.h"

namespace headway::sim {

/// One axis of a vehicle's damped springs, shaken by the ground.
struct Suspension {
  double angle = 0.0;  ///< [rad]
  double rate = 0.0;   ///< [rad/s]

  /// @param shake_rad  standard deviation of the angle in the long run, at `motion` = 1
  /// @param motion     0 at a standstill, 1 at full speed
  /// @param rest_rad   angle at which the springs are at rest, such as a nod while braking
  void advance(double dt, double shake_rad, double motion, double rest_rad, Random& random) {
    constexpr double kStiffness = 2.0 * M_PI * 1.2, kDamping = 0.35;  // [1/s], [-]
    const double shake =
        shake_rad * std::sqrt(4.0 * kDamping * std::pow(kStiffness, 3) / dt) * motion;
    const double acceleration = -kStiffness * kStiffness * (angle - rest_rad) -
                                2.0 * kDamping * kStiffness * rate + shake * random.normal();
    rate += dt * acceleration;
    angle += dt * rate;
  }
};

/// Drives the robot along its route as a car among the others.
class RobotDriver {
 public:
  /// All references must outlive the object.
  ///
  /// @param close_up  keeps little distance, so that what drives ahead fills the view
  RobotDriver(const RouteParams& route_params, double ride_deg, bool close_up, const Route& route,
              std::uint64_t seed);

  void advance(double dt, const std::vector<Obstacle>& others);
  /// Takes away its speed.
  void halt() { at_.speed = 0.0; }
  /// It is where another robot is, which is driven from outside.
  void follow(const Obstacle& robot);
  [[nodiscard]] RobotState state() const;
  /// Robot frame (on the ground below the cameras) in the world.
  [[nodiscard]] Pose T_world_robot() const;
  /// Whether the route is at its end.
  [[nodiscard]] bool arrived() const { return at_.s >= route_.end_s - 0.5; }

 private:
  const Route& route_;
  DriverStyle style_;
  LaneKeeper at_;
  double ride_rad_;
  Random random_;
  Suspension pitch_, roll_;
  std::optional<Obstacle> followed_;
};

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

  /// Puts it, at rest, at the start of a way of two points or more, from where it moves by
  /// commands alone.
  void takeCourse(const std::vector<Eigen::Vector2d>& course);
  /// @pre takeCourse()
  void steer(const DriveCommand& command) { steered_ = command; }
  /// Puts it back to where it was before the last step, at rest.
  void undoStep();
  /// How far along its course it has come [m].
  [[nodiscard]] double progress() const { return progress_; }
  [[nodiscard]] const std::optional<Path>& course() const { return course_; }

  /// Robot frame (on the ground below the cameras) in the world.
  [[nodiscard]] Pose T_world_robot() const;
  /// Forward speed [m/s] and turn rate [rad/s].
  [[nodiscard]] DriveCommand motion() const { return {speed_, turn_rate_}; }
  /// What others see of it.
  [[nodiscard]] Obstacle obstacle() const;
  [[nodiscard]] Eigen::Vector2d position() const { return position_; }
  /// A place on its way, up to so far ahead.
  [[nodiscard]] Eigen::Vector2d ahead(double distance) const;

 private:
  /// Plans a way to the next stop of the tour, or to a random one.
  void chooseStop();
  void planTour();
  /// What the way demands.
  [[nodiscard]] DriveCommand command(double dt);
  [[nodiscard]] DriveCommand drive(double distance, double turn) const;
  /// Rolls on for one step.
  void move(double dt, const DriveCommand& wanted, double brake);
  [[nodiscard]] bool mustStop(const std::vector<Obstacle>& others) const;

  RouteParams route_;
  RobotParams params_;
  double ride_rad_;
  const Site& site_;
  const NavigationGrid& grid_;
  Random random_;
  Eigen::Vector2d position_;
  double yaw_ = 0.0, speed_ = 0.0, turn_rate_ = 0.0;
  std::vector<Eigen::Vector2d> way_;     ///< corners still ahead
  std::vector<Eigen::Vector2d> tour_;    ///< stops, the start last; empty: random stops
  std::size_t toured_ = 0;               ///< stops of the tour chosen so far
  double pause_s_ = 0.5;                 ///< left of standing at a stop
  double sudden_stop_s_ = 0.0;           ///< left of a stop without cause
  double blocked_s_ = 0.0;               ///< time that somebody has been in the way
  bool turning_ = false;                 ///< on the spot
  std::optional<DriveCommand> steered_;  ///< instead of its own decisions
  std::optional<Path> course_;           ///< of a steered robot
  double progress_ = 0.0;                ///< along it [m]
  Eigen::Vector3d before_ = Eigen::Vector3d::Zero();  ///< x, y [m] and yaw, before the last step
  Suspension pitch_, roll_;
};

/// A robot that is driven from outside, at the start of a course between two stops of the site, of
/// 15 to 30 m if there is one, else as near to that as there is.
///
/// @throws InputError if no two stops have a way
[[nodiscard]] WheeledRobot steeredRobot(const SimParams& params, const Site& site,
                                        const NavigationGrid& grid, std::uint64_t seed);

}  // namespace headway::sim
