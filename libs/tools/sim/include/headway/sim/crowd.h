// SPDX-License-Identifier: BSD-3-Clause
// People and pillars of a trial of navigation, seen from above.
#pragma once

#include <headway/core/params.h>

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace headway::sim {

/// How the people of one trial walk.
enum class Scenario {
  kCrossing,   ///< one after the other across the robot's way, timed to meet it
  kFollowing,  ///< slower, the robot's way
  kOncoming,   ///< towards the robot
  kGroups,     ///< two or three abreast, across the robot's way
  kMixed,      ///< one of the above, drawn anew for each trial
};

/// "crossing", "following", "oncoming", "groups", "mixed".
[[nodiscard]] const std::vector<std::pair<std::string, Scenario>>& scenarios();

/// The people, section "people".
struct PeopleParams {
  Scenario scenario = Scenario::kCrossing;
  int count = 3;                   ///< in a trial
  double radius_m = 0.25;          ///< of a body
  double min_speed_mps = 0.8;      ///< minimum preferred speed [m/s]
  double max_speed_mps = 1.5;      ///< maximum preferred speed [m/s]
  double timing_sigma_s = 1.5;     ///< how well they are timed to meet the robot [s]
  double angle_sigma_deg = 20.0;   ///< of the way they cross, about square [deg]
  double wander_sigma_deg = 8.0;   ///< of the heading about the preferred one [deg]
  double speed_sigma_ratio = 0.1;  ///< of the speed, relative to the preferred one [-]
  double wander_time_s = 1.5;      ///< time in which heading and speed change [s]
  double yielding_fraction =
      0.0;          ///< of the people give way to the robot, the others ignore it [-]
  int pillars = 0;  ///< that stand about, away from the straight way

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "people"); }  ///< @throws InputError
};

/// Course of the robot that people are timed to meet: straight along x from the origin.
struct RobotCourse {
  double goal_m = 12.0;        ///< its length [m]
  double top_speed_mps = 1.0;  ///< [m/s]
};

/// Somebody who walks along a preferred way, wandering a little.
struct Person {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< [m]
  double heading = 0.0;                                ///< preferred [rad]
  double speed = 1.0;                                  ///< preferred [m/s]
  double heading_off = 0.0;                            ///< present, from the preferred one [rad]
  double speed_off = 0.0;                              ///< present, ratio of the preferred one
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
/// The same seed gives the same people, whatever the robot does, unless people yield to it.
class Crowd {
 public:
  Crowd(const PeopleParams& people, const RobotCourse& course, std::uint64_t seed);

  /// Lets everybody walk on for a short time.
  void walk(double dt_s, const Eigen::Vector2d& robot);

  [[nodiscard]] const std::vector<Person>& people() const { return people_; }
  [[nodiscard]] const std::vector<Pillar>& pillars() const { return pillars_; }

 private:
  void placePillars(double goal_m);
  void placePeople(Scenario scenario, const RobotCourse& course);
  void placeCrossing(int index, int abreast, const RobotCourse& course);
  void placeAlong(int index, bool oncoming, const RobotCourse& course);
  [[nodiscard]] double normal(double sigma);
  [[nodiscard]] double uniform(double from, double to);
  void add(Person person);

  PeopleParams params_;
  std::mt19937_64 random_;
  std::vector<Person> people_;
  std::vector<Pillar> pillars_;
};

}  // namespace headway::sim
