// SPDX-License-Identifier: BSD-3-Clause
// Whose fault a contact is: rules of counting the collisions and near misses of a drive.
#pragma once

#include <headway/sim/driven_world.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

namespace headway::app {

/// The ground that a part of somebody needs to come to a stop: prolonged by the braking distance.
///
/// @return  to be enlarged by the mover's radius on all sides
/// @see     a walker brakes at 2.5 m/s^2 at most, as in the simulation; cyclists and forklifts, too
[[nodiscard]] sim::Footprint brakingZone(const sim::Footprint& part,
                                         const Eigen::Vector2d& velocity);

/// Speed at which the robot's own motion brings its nearest point nearer to a shape [m/s]; negative
/// if it draws away.
///
/// @param size  length and width of the robot [m]
[[nodiscard]] double approachSpeed(const sim::DrivenRobot& robot, const Eigen::Vector2d& size,
                                   const sim::Footprint& shape);

/// Counts of a drive.
struct ContactCounts {
  std::size_t by_robot = 0;     ///< the robot moved into a person or a braking distance
  std::size_t by_others = 0;    ///< other contacts with who moves: they moved into the robot
  std::size_t with_things = 0;  ///< the robot moved against a thing or to the edge of a drop
  std::size_t near_misses =
      0;  ///< the moving robot and somebody came nearer than 0.3 m, no contact
  double min_distance_m = std::numeric_limits<double>::infinity();  ///< to who moves
};

/// Counts contacts and near misses from step to step.
///
/// A contact with somebody begins when both touch and counts once until they are apart. It is the
/// robot's if the robot approaches at that time, or if it moved into their braking distance before,
/// so that they could not stop for it; else theirs.
class ContactCounter {
 public:
  /// @param size  length and width of the robot [m]
  explicit ContactCounter(const Eigen::Vector2d& size) : size_(size) {}

  /// The world after a step.
  void observe(const sim::DrivenRobot& robot, const std::vector<sim::Mover>& movers, double dt);

  [[nodiscard]] const ContactCounts& counts() const { return counts_; }
  /// Whether the robot touches somebody or a thing now.
  [[nodiscard]] bool touches() const { return touches_; }

 private:
  struct Encounter {
    bool intruded = false;  ///< the robot has moved into the braking distance
    bool touches = false;
    bool is_near = false;  ///< nearer than 0.3 m
    bool moved = false;    ///< the robot has moved since then
    bool touched = false;  ///< there has been contact since then
  };
  void meet(const sim::DrivenRobot& robot, const sim::Mover& mover, Encounter& encounter);

  Eigen::Vector2d size_;
  ContactCounts counts_;
  std::map<std::int64_t, Encounter> encounters_;
  double since_bump_s_ = std::numeric_limits<double>::infinity();
  bool touches_ = false;
};

}  // namespace headway::app
