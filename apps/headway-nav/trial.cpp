// SPDX-License-Identifier: BSD-3-Clause
// A trial: the robot, its navigator, which is MRPT's, and their loop with the tracker.
#include "trial.h"

#include <headway/core/error.h>
#include <headway/core/mrpt_compat.h>
#include <headway/core/stage_times.h>
#include <headway/objects/moving_object_tracker.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/core/Clock.h>
#include <mrpt/nav/reactive/CReactiveNavigationSystem.h>
#include <mrpt/nav/reactive/CRobot2NavInterfaceForSimulator.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <optional>
#include <sstream>

#include "sensors.h"

namespace headway::app {

double RobotParams::radius() const { return 0.5 * std::hypot(length_m, width_m); }

void RobotParams::describe(Params::Section section) {
  section.add("length_m", length_m, 0.1, 5.0, "m", "Length of the robot");
  section.add("width_m", width_m, 0.1, 5.0, "m", "Width of the robot");
  section.add("margin_m", margin_m, 0.0, 1.0, "m",
              "Margin that the navigator adds around the robot");
  section.add("max_speed_mps", max_speed_mps, 0.1, 5.0, "m/s", "Maximum speed");
  section.add("max_turn_dps", max_turn_dps, 5.0, 720.0, "deg/s", "Maximum turn rate");
  section.add("lag_s", lag_s, 0.0, 5.0, "s", "Time constant of the wheels' speed control");
  section.add("goal_m", goal_m, 1.0, 100.0, "m",
              "Distance of the goal, straight ahead of the start");
  section.add("planning_rate_hz", planning_rate_hz, 1.0, 100.0, "Hz",
              "Planning rate of the navigator");
  section.add("planning_reach_m", planning_reach_m, 1.0, 50.0, "m",
              "Planning distance of the navigator; its braking distance scales with it");
  section.add("time_limit_s", time_limit_s, 1.0, 1000.0, "s", "Duration of a trial");
}

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
class ScanningRobot : public mrpt::nav::CRobot2NavInterfaceForSimulator_DiffDriven {
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

  // Events that MRPT would report on standard output.
  bool startWatchdog(float) override { return true; }
  bool stopWatchdog() override { return true; }
  void sendNavigationStartEvent() override {}
  void sendNavigationEndEvent() override {}
  void sendNavigationEndDueToErrorEvent() override {}
  void sendWaySeemsBlockedEvent() override {}
  void sendApparentCollisionEvent() override {}
  void sendCannotGetCloserToBlockedTargetEvent() override {}

 private:
  explicit ScanningRobot(std::unique_ptr<Wheels> wheels)
      : CRobot2NavInterfaceForSimulator_DiffDriven(*wheels), wheels_(std::move(wheels)) {}

  std::unique_ptr<Wheels> wheels_;
  const sim::Crowd* crowd_ = nullptr;
  std::optional<RangeScanner> scanner_;
  double scan_us_ = 0.0;
};

constexpr const char* kHolonomicMethod = "CHolonomicFullEval";

/// Settings that do not depend on the robot.
constexpr const char* kMethod = R"(
[CAbstractNavigator]
dist_to_target_for_sending_event = 0
alarm_seems_not_approaching_target_timeout = 1000
dist_check_target_is_blocked = 0
hysteresis_check_target_is_blocked = 3

[CWaypointsNavigator]
max_distance_to_allow_skip_waypoint = -1
min_timesteps_confirm_skip_waypoints = 1
waypoint_angle_tolerance = 5
multitarget_look_ahead = 0

[CHolonomicFullEval]
factorWeights = [0.25, 0.1, 1, 0.05, 0.5, 1, 1)" HEADWAY_MRPT_EIGHTH_FACTOR R"(]
factorNormalizeOrNot = [0, 0, 0, 0, 1, 1, 0)" HEADWAY_MRPT_EIGHTH_FACTOR R"(]
TOO_CLOSE_OBSTACLE = 0.15
TARGET_SLOW_APPROACHING_DISTANCE = 0.1
OBSTACLE_SLOW_DOWN_DISTANCE = 0.15
HYSTERESIS_SECTOR_COUNT = 5
LOG_SCORE_MATRIX = false
clearance_threshold_ratio = 0.10
gap_width_ratio_threshold = 0.20
PHASE_COUNT = 3
PHASE1_FACTORS = [6]
PHASE1_THRESHOLD = 0.5
PHASE2_FACTORS = [4]
PHASE2_THRESHOLD = 0.7
PHASE3_FACTORS = [0 2]
PHASE3_THRESHOLD = 0.7

[CMultiObjectiveMotionOptimizerBase]
score1_name = target_distance
score1_formula = var d := max(0, target_d_norm-move_cur_d); if(collision_free_distance>d, 1/(1+d^2), 0)
score2_name = collision_free_distance_score
score2_formula = var d := max(0, target_d_norm-move_cur_d); if (collision_free_distance>(d+0.05), 1.0, collision_free_distance)
score3_name = euclidean_nearness
score3_formula = 1/(1+dist_eucl_min^2)
score4_name = hysteresis_score
score4_formula = hysteresis
score5_name = path_index_near_target
score5_formula = var dif:=abs(target_k-move_k); if (dif>(num_paths/2)) { dif:=num_paths-dif; }; exp(-abs(dif / (num_paths/10.0)));
score6_name = ptg_priority_score
score6_formula = ptg_priority
scores_to_normalize =

[CMultiObjMotionOpt_Scalarization]
scalar_score_formula = ptg_priority_score*(0.3*target_distance + 0.5*collision_free_distance_score + 8.0*euclidean_nearness + 0.1*hysteresis_score + 0.2*path_index_near_target)
)";

/// One family of paths: arcs (C) or turns during motion (alpha).
void writePaths(std::ostream& out, int index, const RobotParams& robot, const std::string& kind,
                const std::string& shape) {
  const std::string prefix = "PTG" + std::to_string(index) + "_";
  out << prefix << "Type = CPTG_DiffDrive_" << kind << '\n'
      << prefix << "resolution = 0.05\n"
      << prefix << "refDistance = ${REACH}\n"
      << prefix << "num_paths = 121\n"
      << prefix << "v_max_mps = " << robot.max_speed_mps << '\n'
      << prefix << "w_max_dps = " << robot.max_turn_dps << '\n'
      << shape;
}

/// A temporary folder for the tables that MRPT writes during their computation.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "headway-nav-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw InputError(name + ": no folder can be made there; set TMPDIR to one that is writable");
    }
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

mrpt::config::CConfigFileMemory configuration(const RobotParams& robot) {
  std::ostringstream out;
  out << "@define REACH " << robot.planning_reach_m << '\n' << kMethod;
  out << "[CAbstractPTGBasedReactive]\n"
      << "robotMax_V_mps = " << robot.max_speed_mps << '\n'
      << "robotMax_W_degps = " << robot.max_turn_dps << '\n'
      << "holonomic_method = " << kHolonomicMethod << '\n'
      << "motion_decider_method = CMultiObjMotionOpt_Scalarization\n"
      << "ref_distance = ${REACH}\n"
      << "secure_distance_start = 0.05\n"
      << "secure_distance_end = 0.15\n"
      << "use_delays_model = false\n"
      << "max_distance_predicted_actual_path = 0.15\n"
      << "min_normalized_free_space_for_ptg_continuation = 0.2\n"
      << "enable_obstacle_filtering = false\n"
      << "evaluate_clearance = false\n"
      << "[CReactiveNavigationSystem]\n"
      << "min_obstacles_height = 0\n"
      << "max_obstacles_height = 10\n"
      << "PTG_COUNT = 3\n";
  writePaths(out, 0, robot, "C", "PTG0_K = 1.0\nPTG0_score_priority = 1.0\n");
  writePaths(out, 1, robot, "alpha",
             "PTG1_cte_a0v_deg = 57\nPTG1_cte_a0w_deg = 57\nPTG1_score_priority = 1.0\n");
  writePaths(out, 2, robot, "C", "PTG2_K = -1.0\nPTG2_score_priority = 0.5\n");
  const double x = 0.5 * robot.length_m + robot.margin_m;
  const double y = 0.5 * robot.width_m + robot.margin_m;
  out << "RobotModel_shape2D_xs = " << -x << ' ' << x << ' ' << x << ' ' << -x << '\n'
      << "RobotModel_shape2D_ys = " << y << ' ' << y << ' ' << -y << ' ' << -y << '\n'
      << "RobotModel_circular_shape_radius = " << robot.radius() << '\n';
  mrpt::config::CConfigFileMemory file;
  file.setContent(out.str());
  return file;
}

/// MRPT's reactive navigator without log output, reset for each trial.
///
/// The settings are those of MRPT's reactive2d_config.ini except for the robot's shape and speeds,
/// and the obstacle filter, which is off because it removes objects that move between two scans.
class Navigator : public mrpt::nav::CReactiveNavigationSystem {
 public:
  /// Computes the tables of paths, which takes about a second.
  Navigator(mrpt::nav::CRobot2NavInterface& robot, const RobotParams& params)
      : CReactiveNavigationSystem(robot, false), settings_(configuration(params)) {
    setMinLoggingLevel(mrpt::system::LVL_ERROR);
    // Its report of timings is on standard output.
    m_timlog_delays.enable(false);
    m_timlog_delays.setMinLoggingLevel(mrpt::system::LVL_ERROR);
    loadConfigFile(settings_);
    const ScratchFolder tables;  // MRPT 2.5.8 does not read its own key for this folder
    params_abstract_ptg_navigator.ptg_cache_files_directory = tables.path();
    initialize();
  }

  /// Resets the state and starts towards the goal straight ahead of the start.
  void startAfresh(const RobotParams& robot) {
    resetNavError();
    cancel();
    navigationStep();  // registers the end: else the next path continues the same navigation
    m_latestPoses.clear();
    m_latestOdomPoses.clear();
    setHolonomicMethod(kHolonomicMethod, settings_);  // a new one, because it stores directions
    TNavigationParams request;
    request.target.target_coords = {robot.goal_m, 0.0, 0.0};
    request.target.targetAllowedDistance = static_cast<float>(RobotParams::kGoalRadius_m);
    navigate(&request);
  }

 private:
  mrpt::config::CConfigFileMemory settings_;
};

constexpr double kStep_s = 0.01;  ///< of the world: a walker moves 15 mm in it

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
