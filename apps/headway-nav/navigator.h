// SPDX-License-Identifier: BSD-3-Clause
// MRPT's reactive navigator of a simulated robot, its clock, and the obstacles that it is given.
#pragma once

#include <headway/core/params.h>
#include <headway/core/stage_times.h>
#include <headway/nav/predictive_obstacles.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/core/Clock.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/math/TPose2D.h>
#include <mrpt/nav/reactive/CReactiveNavigationSystem.h>

#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace headway::app {

/// The robot and its goal, section "robot".
struct RobotParams {
  /// Distance from the goal within which it counts as reached [m].
  static constexpr double kGoalRadius_m = 0.4;

  double length_m = 0.5;
  double width_m = 0.4;
  bool reverses = true;         ///< plans ways backwards, where its camera does not look
  double margin_m = 0.0;        ///< that the navigator adds around the robot [m]
  double max_speed_mps = 1.0;   ///< [m/s]
  double max_turn_dps = 120.0;  ///< [deg/s]
  double lag_s = 0.15;          ///< time constant of its wheels' speed control [s]
  double goal_m = 12.0;         ///< straight ahead of the start [m]
  double planning_rate_hz = 20.0;
  double planning_reach_m = 10.0;  ///< planning distance; the braking distance scales with it
  double time_limit_s = 60.0;      ///< duration of a trial [s]

  /// Radius of the smallest circle about its origin that encloses it [m].
  [[nodiscard]] double radius() const;
  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "robot"); }  ///< @throws InputError
};

/// A robot's interface without the events that MRPT reports on standard output.
template <typename Robot>
class Silent : public Robot {
 public:
  using Robot::Robot;

  bool startWatchdog(float /*period_ms*/) override { return true; }
  bool stopWatchdog() override { return true; }
  void sendNavigationStartEvent() override {}
  void sendNavigationEndEvent() override {}
  void sendNavigationEndDueToErrorEvent() override {}
  void sendWaySeemsBlockedEvent() override {}
  void sendApparentCollisionEvent() override {}
  void sendCannotGetCloserToBlockedTargetEvent() override {}
};

/// MRPT's reactive navigator without log output.
///
/// The settings are those of MRPT's reactive2d_config.ini except for the robot's shape and speeds,
/// and the obstacle filter, which is off because it removes objects that move between two scans.
class Navigator : public mrpt::nav::CReactiveNavigationSystem {
 public:
  /// Computes the tables of paths, which takes about a second.
  Navigator(mrpt::nav::CRobot2NavInterface& robot, const RobotParams& params);

  /// Resets the state and starts towards a goal, map frame [m], which is reached within a radius.
  void startAfresh(const Eigen::Vector2d& goal, double radius_m = RobotParams::kGoalRadius_m);
  /// Drives on towards another goal.
  void driveTo(const Eigen::Vector2d& goal, double radius_m = RobotParams::kGoalRadius_m);

 private:
  mrpt::config::CConfigFileMemory settings_;
};

/// Controls MRPT's clock during its lifetime; each instance starts later than the previous one
/// unless a time is given, which suits a new navigator.
class SimulatedClock {
 public:
  SimulatedClock() : SimulatedClock(next_start_s) {}
  explicit SimulatedClock(double start_s) : start_s_(start_s) {
    set(0.0);
    mrpt::Clock::setActiveClock(mrpt::Clock::Simulated);
  }
  ~SimulatedClock() {
    next_start_s = std::ceil(start_s_ + time_s_) + 100.0;
    mrpt::Clock::setActiveClock(mrpt::Clock::Realtime);
  }
  SimulatedClock(const SimulatedClock&) = delete;
  SimulatedClock& operator=(const SimulatedClock&) = delete;

  void set(double time_s) {
    time_s_ = time_s;
    mrpt::Clock::setSimulatedTime(mrpt::Clock::fromDouble(start_s_ + time_s));
  }

 private:
  // A time as of a real clock. Poses of an earlier trial in the navigator must not be in the
  // future.
  static inline double next_start_s = 1.7e9;
  double start_s_;
  double time_s_ = 0.0;
};

/// Records the obstacles given to the planner, and their processor time.
class WatchedObstacles : public nav::PredictiveObstacles {
 public:
  using PredictiveObstacles::PredictiveObstacles;

  bool senseObstacles(mrpt::maps::CSimplePointsMap& obstacles,
                      mrpt::system::TTimeStamp& timestamp) override {
    const double start = processorSeconds();
    const bool safe = PredictiveObstacles::senseObstacles(obstacles, timestamp);
    sense_us_ = 1e6 * (processorSeconds() - start);
    last_ = &obstacles;
    return safe;
  }
  /// In the robot's frame; valid until the navigator's next step.
  [[nodiscard]] const mrpt::maps::CSimplePointsMap& last() const { return *last_; }
  [[nodiscard]] double senseTime_us() const { return sense_us_; }

 private:
  const mrpt::maps::CSimplePointsMap* last_ = nullptr;
  double sense_us_ = 0.0;
};

/// Points of the robot's frame in the map.
[[nodiscard]] std::vector<Eigen::Vector2d> inMap(const mrpt::maps::CSimplePointsMap& points,
                                                 const mrpt::math::TPose2D& robot);

/// Distance from a disc to the robot's footprint; 0 if they overlap [m].
[[nodiscard]] double clearance(const RobotParams& robot, const mrpt::math::TPose2D& pose,
                               const Eigen::Vector2d& centre, double radius);

}  // namespace headway::app
