// SPDX-License-Identifier: BSD-3-Clause
// A world in motion whose robot is driven from outside, by what it sees.
#pragma once

#include <headway/core/object_class.h>
#include <headway/sim/sim_params.h>
#include <headway/sim/simulator.h>

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

namespace headway::sim {

/// What a robot with two driven wheels is told to do.
struct DriveCommand {
  double speed = 0.0;      ///< forward [m/s]
  double turn_rate = 0.0;  ///< counter-clockwise [rad/s]
};

/// The robot on the ground.
struct DrivenRobot {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< map frame [m]
  double yaw = 0.0;                                    ///< [rad]
  DriveCommand motion;                                 ///< as it moves now
  bool bumped = false;  ///< a thing, or the edge of a drop, stopped it in the last step
};

/// Somebody or something that moves, or may move, seen from above.
struct Mover {
  std::int64_t id = -1;
  ObjectClass object_class = ObjectClass::kUnknown;
  Footprint shape;               ///< map frame; of a person, a point
  std::vector<Footprint> parts;  ///< of it what can be touched: of a forklift, body and forks
  double radius_m = 0.0;         ///< about the parts: of a person half the width of the shoulders
  double height_m = 0.0;
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< map frame [m/s]
};

/// A world in motion, seen by a rig on a robot that is driven from outside.
///
/// The robot has a course of 15 to 30 m to drive, on which it meets people: some come towards it,
/// cross, are overtaken or overtake, stand, or step out from where they were hidden; half of all
/// who walk ignore it. Without [traffic] pedestrians it meets no one. World, course and people
/// depend on the parameters alone, how people walk also on where the robot is. The map frame is the
/// robot's first pose. A thing stops the robot, people do not. Used in one thread.
///
///     DrivenWorld world(params, {0.5, 0.4});
///     while (!arrived(world.robot())) {
///       const DriveCommand command = decide(world.look());
///       for (int i = 0; i < steps; ++i) world.advance(step_s, command);
///     }
class DrivenWorld {
 public:
  /// @param robot_size  length and width of the robot [m]
  /// @throws InputError naming the key of parameters that cannot be
  DrivenWorld(const SimParams& params, const Eigen::Vector2d& robot_size);
  ~DrivenWorld();
  DrivenWorld(const DrivenWorld&) = delete;
  DrivenWorld& operator=(const DrivenWorld&) = delete;

  /// Lets a short time pass, in which the robot does as it is told as far as its wheels can.
  void advance(double dt, const DriveCommand& command);
  /// The frame that the rig takes now, with its wheels' odometry; its scene is made with the first
  /// one.
  [[nodiscard]] SimFrame look();

  [[nodiscard]] DrivenRobot robot() const;
  /// Places of the course, a metre apart, map frame; the start first, the goal last.
  [[nodiscard]] const std::vector<Eigen::Vector2d>& course() const;
  [[nodiscard]] std::vector<Mover> movers() const;
  /// What is impassable and stays where it is: things on the ground, and edges of drops; map frame.
  [[nodiscard]] const std::vector<Footprint>& things() const;
  /// Time of the frame that would be taken now [s].
  [[nodiscard]] Time now() const;
  /// As Simulator's.
  [[nodiscard]] const StereoCamera& camera() const;
  [[nodiscard]] io::RawStereoCamera recordedCamera() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Distance between two rectangles [m]; 0 if they overlap.
[[nodiscard]] double gapBetween(const Footprint& a, const Footprint& b);

}  // namespace headway::sim
