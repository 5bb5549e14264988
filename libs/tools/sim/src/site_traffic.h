// SPDX-License-Identifier: BSD-3-Clause
// People and vehicles that move on a site.
#pragma once

#include <headway/core/random.h>
#include <headway/core/stereo_camera.h>
#include <headway/sim/sim_params.h>

#include <optional>
#include <vector>

#include "driving.h"
#include "navigation_grid.h"
#include "robot.h"
#include "site.h"

namespace headway::sim {

/// People in a site: they walk from place to place, avoid walls, each other and the robot, pass
/// close by it, stop, wait and turn round; others stand or sit all the time.
///
/// @see Karamouzas, Heil, van Beek & Overmars 2009, "A predictive collision avoidance model for
///      pedestrian simulation": who will come too near soon steps aside as little as needed
class Walkers {
 public:
  /// Distance between the middles of a person and the robot that people keep [m].
  static constexpr double kPassing = 0.62;

  /// Site and grid must outlive the object.
  Walkers(const TrafficParams& params, const Site& site, const NavigationGrid& grid,
          std::uint64_t seed);

  /// Puts everybody into their first places, away from the robot.
  void populate(const WheeledRobot& robot, std::int64_t& next_id);
  /// Adds people whom a robot with a course meets on it, and lets half of all who walk ignore it.
  void meet(const WheeledRobot& robot, std::uint64_t seed, std::int64_t& next_id);
  /// @param vehicles  all others but the robot
  void advance(double dt, const WheeledRobot& robot, const std::vector<Obstacle>& vehicles);
  [[nodiscard]] const std::vector<Actor>& actors() const { return actors_; }

 private:
  struct Person {
    Eigen::Vector2d at = Eigen::Vector2d::Zero();        ///< world [m]
    Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< [m/s]
    double desired_speed_mps = 1.2;
    std::vector<Eigen::Vector2d> way;  ///< corners still ahead
    double pause_s = 0.0;              ///< left of standing
    double stuck_s = 0.0;              ///< time without getting on
    bool idle = false;                 ///< never walks
    bool ignores_robot = false;
    double sets_off_m = 0.0;  ///< when the robot has come so far on its course [m]
  };

  void addWalker(const WheeledRobot& robot, std::int64_t& next_id);
  /// How somebody is met on the robot's course.
  enum class Meeting { kOncoming, kCrossing, kOvertaken, kStanding, kOvertaking, kHidden };
  /// Somebody who is met at a place of the course; nullopt without room for it.
  [[nodiscard]] std::optional<Person> meetingAt(Meeting kind, const Path& course, double s,
                                                Random& random) const;
  /// A place from which somebody walks to the course, in view of the robot or not.
  [[nodiscard]] std::optional<Eigen::Vector2d> besideCourse(const Path& course, double s,
                                                            bool hidden, Random& random) const;
  void addIdle(const Spot& spot, std::int64_t& next_id);
  void addActor(const Person& person, ActorKind kind, double yaw, std::int64_t& next_id);
  void chooseWay(Person& person, const WheeledRobot& robot);
  /// Lets somebody go on from the end of the way, to a destination.
  void prolongWay(Person& person, Random& random) const;
  [[nodiscard]] Eigen::Vector2d desiredVelocity(Person& person, double dt,
                                                const WheeledRobot& robot);
  /// Steps aside for all who will be too near soon.
  [[nodiscard]] Eigen::Vector2d avoiding(std::size_t i, Eigen::Vector2d velocity,
                                         const Obstacle& robot,
                                         const std::vector<Obstacle>& vehicles) const;
  void move(Person& person, double dt, const Obstacle& robot) const;
  void place(std::size_t i, double dt);

  TrafficParams params_;
  const Site& site_;
  const NavigationGrid& grid_;
  Random random_;
  Random bodies_;               ///< varied ones
  std::vector<Person> people_;  ///< same order as actors_
  std::vector<Actor> actors_;
};

/// People who walk with the robot close before its camera and cover part of its view. Nobody else
/// heeds them; where a wall is nearer than they are, it hides them.
class CoveringPeople {
 public:
  /// @param camera  whose left image they cover by TrafficParams::cover
  CoveringPeople(const TrafficParams& params, const StereoCamera& camera, std::uint64_t seed,
                 std::int64_t& next_id);

  void advance(double dt, const Pose& T_world_robot);
  [[nodiscard]] const std::vector<Actor>& actors() const { return actors_; }

 private:
  StereoCamera camera_;
  double ahead_m_ = 0.0;       ///< of the camera
  double seconds_ = 0.0;       ///< so far
  std::vector<double> sways_;  ///< from side to side, each at a rate of its own [rad/s]
  std::vector<Actor> actors_;
};

/// Forklifts, cyclists and delivery robots that go round the loops of a site, and brake for
/// everybody in their way.
class LoopVehicles {
 public:
  /// Vehicles spread over the loops, each far enough from the robot to brake for it.
  LoopVehicles(const TrafficParams& params, const Site& site, const Obstacle& robot,
               std::uint64_t seed, std::int64_t& next_id);

  void advance(double dt, const std::vector<Obstacle>& others);
  [[nodiscard]] const std::vector<Actor>& actors() const { return actors_; }

 private:
  void add(const VehicleLoop& loop, double ratio, const Obstacle& robot, std::int64_t& next_id);
  void place(std::size_t i, double dt);

  struct Vehicle {
    Path path;
    OnPath at;
    DriverStyle style;
  };
  Random random_;
  std::vector<Vehicle> vehicles_;  ///< same order as actors_
  std::vector<Actor> actors_;
};

}  // namespace headway::sim
