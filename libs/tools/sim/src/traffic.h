// SPDX-License-Identifier: BSD-3-Clause
// All who move along the streets; the pedestrians among them.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/sim/sim_params.h>

#include <cstdint>
#include <vector>

#include "robot.h"
#include "vehicles.h"

namespace headway::sim {

/// People near the robot: they walk along pavements alone or in groups, avoid each other, stop,
/// turn round, and cross the street when the traffic leaves a gap.
///
/// Places are kept in the street's coordinates (along, to the left), forces act in them.
/// @see Helbing & Molnar 1995, "Social force model for pedestrian dynamics"; Weidmann 1993,
///      "Transporttechnik der Fussgaenger": walking speeds 1.34 +- 0.26 m/s
class Pedestrians {
 public:
  /// Route and network must outlive the object.
  Pedestrians(const TrafficParams& params, const Route& route, const RoadNetwork& network,
              std::uint64_t seed);

  void populate(const RobotState& robot, std::int64_t& next_id);
  /// @param vehicles  everything on wheels, the robot included
  void advance(double dt, const RobotState& robot, const std::vector<Obstacle>& vehicles,
               std::int64_t& next_id);
  [[nodiscard]] const std::vector<Actor>& actors() const { return actors_; }

 private:
  enum class State { kWalking, kStanding, kWaiting, kCrossing };
  struct Person {
    State state = State::kWalking;
    Eigen::Vector2d at = Eigen::Vector2d::Zero();        ///< (along, left) of the street [m]
    Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< the same axes [m/s]
    double direction = 1.0;                              ///< along the street, +1 or -1
    double lane = 7.9;  ///< signed distance from the street's middle it likes [m]
    double desired_speed_mps = 1.34;
    double timer_s = 0.0;                              ///< left of standing
    std::int64_t leader = -1;                          ///< id of whom it walks with
    Eigen::Vector2d offset = Eigen::Vector2d::Zero();  ///< from the leader
  };

  /// Draws where on the pavements somebody wants to walk, which way and how fast.
  void drawIntent(Person& person);
  void spawnGroup(const RobotState& robot, bool anywhere, int at_most, std::int64_t& next_id);
  void spawnBeforeCamera(const RobotState& robot, std::int64_t& next_id);
  void add(Person person, std::int64_t& next_id);
  void decide(Person& person, double dt, const std::vector<Obstacle>& vehicles);
  [[nodiscard]] bool mayCross(const Person& person, const std::vector<Obstacle>& vehicles) const;
  [[nodiscard]] Eigen::Vector2d desiredVelocity(const Person& person) const;
  [[nodiscard]] Eigen::Vector2d repulsion(std::size_t i) const;
  void place(std::size_t i, double dt);
  void retire(const RobotState& robot);
  [[nodiscard]] double groundAt(const Person& person) const;
  [[nodiscard]] const Person* find(std::int64_t id) const;

  TrafficParams params_;
  const Route& route_;
  const RoadNetwork& network_;
  Random random_;
  std::vector<Person> people_;  ///< same order as actors_
  std::vector<Actor> actors_;
};

struct TrafficSeeds {
  std::uint64_t vehicles = 0;
  std::uint64_t pedestrians = 0;
  std::uint64_t robot = 0;
  std::uint64_t escort = 0;
};

/// The robot and all who move around it: each sees those who may be in its way, and then all go on.
class Traffic {
 public:
  /// Route and network must outlive the object.
  ///
  /// @param camera  in whose left image the escort covers its ratio
  /// @throws InputError as Escort
  Traffic(const SimParams& params, const Route& route, const RoadNetwork& network,
          const StereoCamera& camera, const TrafficSeeds& seeds);

  void advance(double dt);
  /// The robot is where another one is, which is driven from outside.
  void follow(const Obstacle& robot) { robot_.follow(robot); }
  /// The camera takes a frame: the escort sees how much of it actors cover.
  void observe() { escort_.observe(robot_.T_world_robot(), others()); }

  [[nodiscard]] const RobotDriver& robot() const { return robot_; }
  [[nodiscard]] const Vehicles& vehicles() const { return vehicles_; }
  [[nodiscard]] const Pedestrians& pedestrians() const { return pedestrians_; }
  /// All but the robot: vehicles, people, the escort.
  [[nodiscard]] std::vector<Actor> actors() const;

 private:
  [[nodiscard]] std::vector<Actor> others() const;  ///< but for the escort

  bool standing_;
  RobotDriver robot_;
  std::int64_t next_id_ = 0;
  Escort escort_;
  Vehicles vehicles_;
  Pedestrians pedestrians_;
};

}  // namespace headway::sim
