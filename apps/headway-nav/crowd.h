#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "trial_params.h"

namespace headway::app {

using Random = std::mt19937_64;

/// Somebody who walks along a preferred way, wandering a little.
struct Person {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< [m]
  double heading = 0.0;                                ///< preferred [rad]
  double speed = 1.0;                                  ///< preferred [m/s]
  double heading_off = 0.0;                            ///< present, from the preferred one [rad]
  double speed_off = 0.0;                              ///< present, share of the preferred one
  double radius = 0.25;                                ///< [m]
  bool yields = false;                                 ///< gives way to the robot

  [[nodiscard]] Eigen::Vector2d velocity() const;
};

/// A round pillar.
struct Pillar {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< [m]
  double radius = 0.2;                                 ///< [m]
};

/// What moves and what stands in one trial; the robot starts at the origin along x.
///
/// The same seed gives the same people, whatever the robot does, as long as nobody yields.
class Crowd {
 public:
  Crowd(const PeopleParams& people, const RobotParams& robot, std::uint64_t seed);

  /// Lets everybody walk on for a short time.
  void walk(double dt_s, const Eigen::Vector2d& robot);

  [[nodiscard]] const std::vector<Person>& people() const { return people_; }
  [[nodiscard]] const std::vector<Pillar>& pillars() const { return pillars_; }

 private:
  void placePillars(double goal_m);
  void placePeople(Scenario scenario, const RobotParams& robot);
  void placeCrossing(int index, int abreast, const RobotParams& robot);
  void placeAlong(int index, bool oncoming, const RobotParams& robot);
  [[nodiscard]] double normal(double sigma);
  [[nodiscard]] double uniform(double from, double to);
  void add(Person person);

  PeopleParams params_;
  Random random_;
  std::vector<Person> people_;
  std::vector<Pillar> pillars_;
};

}  // namespace headway::app
