// SPDX-License-Identifier: BSD-3-Clause
#include "trial.h"

#include <headway/core/stage_times.h>
#include <headway/objects/moving_object_tracker.h>
#include <mrpt/core/Clock.h>

#include <cmath>
#include <limits>

#include "navigator.h"
#include "noisy_detector.h"
#include "scanning_robot.h"

namespace headway::app {
namespace {

using Eigen::Vector2d;
using mrpt::maps::CSimplePointsMap;
using mrpt::math::TPose2D;
using mrpt::nav::CAbstractNavigator;

constexpr double kEpoch_s = 1.7e9;  ///< MRPT's clock at the start of the first trial
constexpr double kStep_s = 0.01;    ///< of the world

/// Controls MRPT's clock during its lifetime; each instance starts later than the previous one.
class SimulatedClock {
 public:
  SimulatedClock() : start_s_(next_start_s) {
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
  // Poses of an earlier trial in the navigator must not be in the future.
  static inline double next_start_s = kEpoch_s;
  double start_s_;
  double time_s_ = 0.0;
};

/// Records the obstacles given to the planner, and their processor time.
class WatchedObstacles : public nav::PredictiveObstacles {
 public:
  using PredictiveObstacles::PredictiveObstacles;

  bool senseObstacles(CSimplePointsMap& obstacles, mrpt::system::TTimeStamp& timestamp) override {
    const double start = processorSeconds();
    const bool safe = PredictiveObstacles::senseObstacles(obstacles, timestamp);
    sense_us_ = 1e6 * (processorSeconds() - start);
    last_ = &obstacles;
    return safe;
  }
  /// In the robot's frame; valid until the navigator's next step.
  [[nodiscard]] const CSimplePointsMap& last() const { return *last_; }
  [[nodiscard]] double senseTime_us() const { return sense_us_; }

 private:
  const CSimplePointsMap* last_ = nullptr;
  double sense_us_ = 0.0;
};

std::vector<Vector2d> inMap(const CSimplePointsMap& points, const TPose2D& robot) {
  const Eigen::Rotation2Dd turn(robot.phi);
  std::vector<Vector2d> result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    float x = 0.f, y = 0.f, z = 0.f;
    points.getPoint(i, x, y, z);
    result.push_back(Vector2d(robot.x, robot.y) + turn * Vector2d(x, y));
  }
  return result;
}

}  // namespace

/// Created once: the robot and its navigator, whose tables are expensive.
class TrialRunner::Machine {
 public:
  explicit Machine(const TrialSetup& with)
      : setup(with),
        robot(with.world.robot),
        obstacles(
            robot, [this] { return map; }, with.nav, [this] { return time_s; }),
        navigator(obstacles, with.world.robot) {
    obstacles.setMinLoggingLevel(mrpt::system::LVL_ERROR);
  }

  TrialSetup setup;
  ScanningRobot robot;
  map::PerceptionMap map;
  double time_s = 0.0;  ///< since the start of the trial; the map is dated in it
  WatchedObstacles obstacles;
  Navigator navigator;
};

/// A running trial.
class TrialRunner::Trial {
 public:
  Trial(Machine& machine, std::uint64_t seed)
      : machine_(machine),
        world_(machine.setup.world),
        crowd_(world_.people, {world_.robot.goal_m, world_.robot.max_speed_mps}, 3 * seed),
        detector_(world_.sensors, 3 * seed + 1),
        tracker_(machine.setup.objects) {
    machine_.robot.start(crowd_, RangeScanner(world_.sensors, 3 * seed + 2));
    machine_.map = map::PerceptionMap();
    result_.seed = seed;
    result_.min_distance_m = std::numeric_limits<double>::infinity();
  }

  TrialResult run(const TrialObserver& observer) {
    const long steps_per_plan = stepsPer(world_.robot.planning_rate_hz);
    const long steps_per_detection = stepsPer(world_.sensors.detection_rate_hz);
    const long steps = std::lround(world_.robot.time_limit_s / kStep_s);
    for (long step = 0; step < steps && !result_.goal_reached; ++step) {
      machine_.time_s = static_cast<double>(step) * kStep_s;
      clock_.set(machine_.time_s);
      if (step == 0) machine_.navigator.startAfresh(world_.robot);
      if (step % steps_per_detection == 0) perceive();
      if (step % steps_per_plan == 0) plan(observer);
      moveOn();
    }
    result_.time_to_goal_s = machine_.time_s;
    return result_;
  }

 private:
  static long stepsPer(double rate_hz) {
    return std::max(1L, std::lround(1.0 / (rate_hz * kStep_s)));
  }

  void perceive() {
    const TPose2D& pose = machine_.robot.pose();
    const Time now = machine_.time_s;
    const auto detections = detector_.detect(crowd_, pose, now);
    const auto update = tracker_.update(frame_++, {now, poseOf(pose)}, detections);
    machine_.map.update(now, update.tracks);
  }

  void plan(const TrialObserver& observer) {
    const double start = processorSeconds();
    machine_.navigator.navigationStep();
    const double scan_us = machine_.robot.scanTime_us();
    result_.step_us.push_back(1e6 * (processorSeconds() - start) - scan_us);
    result_.sense_us.push_back(machine_.obstacles.senseTime_us() - scan_us);
    if (machine_.obstacles.lastReport().status != nav::SenseStatus::kSafe) ++result_.unsafe_steps;
    if (observer) observer(moment());
    contact_ = false;
    const auto state = machine_.navigator.getCurrentState();
    if (state == CAbstractNavigator::IDLE) result_.goal_reached = true;
    if (state == CAbstractNavigator::NAV_ERROR) {  // retries, like a robot's program
      machine_.navigator.startAfresh(world_.robot);
    }
  }

  void moveOn() {
    machine_.robot.moveOn(kStep_s);
    const TPose2D& pose = machine_.robot.pose();
    crowd_.walk(kStep_s, {pose.x, pose.y});
    for (const auto& person : crowd_.people()) {
      const double distance = clearance(world_.robot, pose, person.position, person.radius);
      result_.min_distance_m = std::min(result_.min_distance_m, distance);
      if (distance > 0.0) continue;
      contact_ = true;
      (machine_.robot.moves() ? result_.collided : result_.walked_into) = true;
    }
    for (const auto& pillar : crowd_.pillars()) {
      if (clearance(world_.robot, pose, pillar.position, pillar.radius) > 0.0) continue;
      result_.pillar_touched = true;
    }
  }

  [[nodiscard]] TrialMoment moment() const {
    TrialMoment moment;
    moment.time_s = machine_.time_s;
    moment.robot = machine_.robot.pose();
    moment.people = crowd_.people();
    moment.pillars = crowd_.pillars();
    moment.tracks = machine_.map.movingObjects().tracks();
    moment.obstacles = inMap(machine_.obstacles.last(), moment.robot);
    moment.contact = contact_;
    return moment;
  }

  Machine& machine_;
  const TrialParams& world_;
  SimulatedClock clock_;
  sim::Crowd crowd_;
  NoisyDetector detector_;
  objects::MovingObjectTracker tracker_;
  TrialResult result_;
  std::size_t frame_ = 0;
  bool contact_ = false;
};

TrialRunner::TrialRunner(const TrialSetup& setup) {
  setup.world.validate();
  machine_ = std::make_unique<Machine>(setup);
}

TrialRunner::~TrialRunner() = default;

TrialResult TrialRunner::run(std::uint64_t seed, const TrialObserver& observer) {
  return Trial(*machine_, seed).run(observer);
}

double clearance(const RobotParams& robot, const TPose2D& pose, const Vector2d& centre,
                 double radius) {
  const Vector2d local = Eigen::Rotation2Dd(-pose.phi) * (centre - Vector2d(pose.x, pose.y));
  const Vector2d half(0.5 * robot.length_m, 0.5 * robot.width_m);
  const Vector2d outside = (local.cwiseAbs() - half).cwiseMax(0.0);
  return std::max(0.0, outside.norm() - radius);
}

}  // namespace headway::app
