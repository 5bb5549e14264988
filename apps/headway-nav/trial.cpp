// SPDX-License-Identifier: BSD-3-Clause
// A trial: the robot, its navigator, which is MRPT's, and their loop with the tracker.
#include "trial.h"

#include <headway/core/stage_times.h>
#include <headway/objects/moving_object_tracker.h>
#include <mrpt/nav/reactive/CRobot2NavInterfaceForSimulator.h>

#include <cmath>
#include <limits>
#include <optional>

#include "sensors.h"

namespace headway::app {

void SensorParams::describe(Params::Section section) {
  section.add("scan_range_m", scan_range_m, 0.5, 100.0, "m", "Range of the scanner");
  section.add("scan_sigma_m", scan_sigma_m, 0.0, 1.0, "m", "Noise of the scanner");
  section.add("detection_rate_hz", detection_rate_hz, 1.0, 50.0, "Hz", "Rate of the detector");
  section.add("detection_range_m", detection_range_m, 1.0, 100.0, "m", "Range of the detector");
  section.add(
      "field_of_view_deg", field_of_view_deg, 10.0, 360.0, "deg",
      "Field of view of the detector, centred straight ahead; the scanner covers 360 degrees");
  section.add("along_sigma_m", along_sigma_m, 0.0, 2.0, "m",
              "Noise of a detected position along the ray");
  section.add("along_sigma_per_m", along_sigma_per_m, 0.0, 1.0, "m/m",
              "Growth of that noise with distance");
  section.add("across_ratio", across_ratio, 0.0, 2.0, "-",
              "Ratio of the noise across the ray to that along it");
  section.add("size_sigma_m", size_sigma_m, 0.0, 1.0, "m",
              "Noise of a detected width; length and height in proportion");
  section.add("yaw_sigma_deg", yaw_sigma_deg, 0.0, 90.0, "deg", "Noise of a detected heading");
  section.add("flip_probability", flip_probability, 0.0, 1.0, "-",
              "Probability that a detected heading is reversed");
  section.add("miss_probability", miss_probability, 0.0, 1.0, "-",
              "Probability that a person is not detected in a frame");
  section.add("duplicate_probability", duplicate_probability, 0.0, 1.0, "-",
              "Probability that a person is detected twice in a frame");
  section.add("false_alarm_probability", false_alarm_probability, 0.0, 1.0, "-",
              "Probability of a false alarm in a frame");
}

void TrialParams::describe(Params& params) {
  robot.describe(params.section("robot").user());
  people.describe(params.section("people").user());
  sensors.describe(params.section("sensors").user());
}

namespace {

using Eigen::Vector2d;
using mrpt::maps::CSimplePointsMap;
using mrpt::math::TPose2D;
using mrpt::nav::CAbstractNavigator;
using Wheels = mrpt::kinematics::CVehicleSimul_DiffDriven;

/// MRPT's simulated robot with a range scanner, reset for each trial.
class ScanningRobot : public Silent<mrpt::nav::CRobot2NavInterfaceForSimulator_DiffDriven> {
 public:
  explicit ScanningRobot(const RobotParams& params) : ScanningRobot(std::make_unique<Wheels>()) {
    wheels_->setDelayModelParams(params.lag_s, 0.0);
  }

  /// Puts the robot, at rest, at the origin of a new world; `crowd` must outlive the trial.
  void start(const sim::Crowd& crowd, const RangeScanner& scanner) {
    crowd_ = &crowd;
    scanner_ = scanner;
    wheels_->resetStatus();
    wheels_->resetTime();
    wheels_->setCurrentGTPose({0.0, 0.0, 0.0});
    wheels_->movementCommand(0.0, 0.0);
  }

  bool senseObstacles(CSimplePointsMap& obstacles, mrpt::system::TTimeStamp& timestamp) override {
    const double start = processorSeconds();
    scanner_->scan(*crowd_, pose(), obstacles);
    timestamp = mrpt::Clock::now();
    scan_us_ = 1e6 * (processorSeconds() - start);
    return true;
  }

  void moveOn(double dt_s) { wheels_->simulateOneTimeStep(dt_s); }

  [[nodiscard]] const TPose2D& pose() const { return wheels_->getCurrentGTPose(); }
  /// Whether it drives or turns.
  [[nodiscard]] bool moves() {
    // Slower wheels are the remains of their lag: [m/s], [rad/s].
    return std::abs(wheels_->getV()) > 0.02 || std::abs(wheels_->getW()) > 0.05;
  }

  /// Processor time of simulating the last scan [us].
  [[nodiscard]] double scanTime_us() const { return scan_us_; }

 private:
  explicit ScanningRobot(std::unique_ptr<Wheels> wheels)
      : Silent(*wheels), wheels_(std::move(wheels)) {}

  std::unique_ptr<Wheels> wheels_;
  const sim::Crowd* crowd_ = nullptr;
  std::optional<RangeScanner> scanner_;
  double scan_us_ = 0.0;
};

constexpr double kStep_s = 0.01;  ///< of the world: a walker moves 15 mm in it

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
    auto scene = std::make_shared<TrialScene>();
    scene->goal = {world_.robot.goal_m, 0.0};
    scene_ = scene;
  }

  TrialResult run(const TrialObserver& observer) {
    const long steps_per_plan = stepsPer(world_.robot.planning_rate_hz);
    const long steps_per_detection = stepsPer(world_.sensors.detection_rate_hz);
    const long steps = std::lround(world_.robot.time_limit_s / kStep_s);
    for (long step = 0; step < steps && !result_.goal_reached; ++step) {
      machine_.time_s = static_cast<double>(step) * kStep_s;
      clock_.set(machine_.time_s);
      if (step == 0) machine_.navigator.startAfresh({world_.robot.goal_m, 0.0});
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
      machine_.navigator.startAfresh({world_.robot.goal_m, 0.0});
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
    moment.scene = scene_;
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
  std::shared_ptr<const TrialScene> scene_;
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

}  // namespace headway::app
