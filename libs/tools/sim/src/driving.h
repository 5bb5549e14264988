// SPDX-License-Identifier: BSD-3-Clause
// Drivers: how they follow paths and lanes, and brake for others.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "actor.h"
#include "route.h"

namespace headway::sim {

/// What a driver sees of anything else on the street: an upright box with a velocity.
struct Obstacle {
  std::int64_t id = -1;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< world [m]
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< world [m/s]
  double yaw = 0.0;                                    ///< [rad]
  double length = 1.0;
  double width = 1.0;
  bool on_foot = false;
};

inline constexpr std::int64_t kRobotId = -2;  ///< of the robot's own obstacle

[[nodiscard]] Obstacle obstacleFrom(const Actor& actor);
[[nodiscard]] std::vector<Obstacle> obstaclesFrom(const std::vector<Actor>& actors);

/// Puts a vehicle on its path, and turns a cyclist's pedals.
void placeOn(const PathPoint& point, double speed, double dt, Actor& actor);

/// How a driver drives. Typical values of city traffic.
///
/// @see Treiber, Hennecke & Helbing 2000, "Congested traffic states in empirical observations and
///      microscopic simulations" (intelligent driver model)
struct DriverStyle {
  double desired_speed_mps = 8.0;
  double acceleration = 1.4;       ///< [m/s^2]
  double comfortable_brake = 2.0;  ///< [m/s^2]
  double hardest_brake = 7.0;      ///< [m/s^2]
  double headway_s = 1.2;
  double standstill_m = 2.0;  ///< gap when standing
  double lateral = 2.0;       ///< acceleration accepted in curves [m/s^2]
};

/// A vehicle on its path.
struct OnPath {
  double s = 0.0;      ///< of its middle along the path [m]
  double speed = 0.0;  ///< [m/s]
  double length = 4.5;
  double width = 1.8;
};

/// Acceleration of a driver who keeps to a path behind and around everything else.
///
/// People who are about to step in front of the vehicle count as standing in its way.
///
/// @param stop_s  place on the path not to be passed now (a yield line); infinity: none
[[nodiscard]] double drive(const OnPath& self, const Path& path, const DriverStyle& style,
                           const std::vector<Obstacle>& others, std::int64_t own_id, double stop_s);

/// A vehicle that never leaves one lane of the route's street.
///
/// Its place is kept along the street's middle, where the lanes of both sides can be compared.
class LaneKeeper {
 public:
  /// @param left  of the lane from the street's middle [m]
  /// The route must outlive the object.
  LaneKeeper(const Route& route, double left);

  double s = 0.0;      ///< along the street [m]
  double speed = 0.0;  ///< [m/s]
  double length = 4.5;
  double width = 1.8;

  /// What a driver of that style does behind and around the others.
  [[nodiscard]] double acceleration(const DriverStyle& style, const std::vector<Obstacle>& others,
                                    std::int64_t own_id);
  /// One step of time; never backwards.
  void move(double dt, double acceleration);
  [[nodiscard]] PathPoint place() const;

 private:
  [[nodiscard]] double alongLane();

  const Route& route_;
  double left_;
  Path lane_;
  /// The place found last: along the street and along the lane, which differ in curves [m].
  std::optional<std::pair<double, double>> found_;
};

}  // namespace headway::sim
