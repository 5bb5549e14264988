// SPDX-License-Identifier: BSD-3-Clause
// MRPT's reactive navigator of a simulated robot, its clock, and the obstacles that it is given.
#include "navigator.h"

#include <headway/core/error.h>
#include <headway/core/mrpt_compat.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>

namespace headway::app {

using Eigen::Vector2d;

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

namespace {

constexpr const char* kHolonomicMethod = "CHolonomicFullEval";

// Free lengths of paths, which MRPT takes as ratios of the planning distance [m].
constexpr double kTooClose_m = 0.2;  // shorter paths are not taken: as near as a door lets pass
constexpr double kStop_m = 0.07;     // on shorter ones it stops: cells of MRPT's tables are 0.05 m
constexpr double kSlow_m = 1.5;      // on shorter ones it slows down: twice what it brakes in

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
TOO_CLOSE_OBSTACLE = ${TOO_CLOSE}
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
  const double reach = robot.planning_reach_m;
  out << "@define REACH " << reach << "\n@define TOO_CLOSE " << kTooClose_m / reach << '\n'
      << kMethod;
  out << "[CAbstractPTGBasedReactive]\n"
      << "robotMax_V_mps = " << robot.max_speed_mps << '\n'
      << "robotMax_W_degps = " << robot.max_turn_dps << '\n'
      << "holonomic_method = " << kHolonomicMethod << '\n'
      << "motion_decider_method = CMultiObjMotionOpt_Scalarization\n"
      << "ref_distance = ${REACH}\n"
      << "secure_distance_start = " << kStop_m / reach << '\n'
      << "secure_distance_end = " << std::min(1.0, kSlow_m / reach) << '\n'
      << "use_delays_model = false\n"
      << "max_distance_predicted_actual_path = 0.15\n"
      << "min_normalized_free_space_for_ptg_continuation = 0.2\n"
      << "enable_obstacle_filtering = false\n"
      << "evaluate_clearance = false\n"
      << "[CReactiveNavigationSystem]\n"
      << "min_obstacles_height = 0\n"
      << "max_obstacles_height = 10\n"
      << "PTG_COUNT = " << (robot.reverses ? 3 : 2) << '\n';
  writePaths(out, 0, robot, "C", "PTG0_K = 1.0\nPTG0_score_priority = 1.0\n");
  writePaths(out, 1, robot, "alpha",
             "PTG1_cte_a0v_deg = 57\nPTG1_cte_a0w_deg = 57\nPTG1_score_priority = 1.0\n");
  if (robot.reverses) writePaths(out, 2, robot, "C", "PTG2_K = -1.0\nPTG2_score_priority = 0.5\n");
  const double x = 0.5 * robot.length_m + robot.margin_m;
  const double y = 0.5 * robot.width_m + robot.margin_m;
  out << "RobotModel_shape2D_xs = " << -x << ' ' << x << ' ' << x << ' ' << -x << '\n'
      << "RobotModel_shape2D_ys = " << y << ' ' << y << ' ' << -y << ' ' << -y << '\n'
      << "RobotModel_circular_shape_radius = " << robot.radius() << '\n';
  mrpt::config::CConfigFileMemory file;
  file.setContent(out.str());
  return file;
}

}  // namespace

Navigator::Navigator(mrpt::nav::CRobot2NavInterface& robot, const RobotParams& params)
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

void Navigator::startAfresh(const Vector2d& goal, double radius_m) {
  resetNavError();
  cancel();
  navigationStep();  // registers the end: else the next path continues the same navigation
  m_latestPoses.clear();
  m_latestOdomPoses.clear();
  setHolonomicMethod(kHolonomicMethod, settings_);  // a new one, because it stores directions
  driveTo(goal, radius_m);
}

void Navigator::driveTo(const Vector2d& goal, double radius_m) {
  TNavigationParams request;
  request.target.target_coords = {goal.x(), goal.y(), 0.0};
  request.target.targetAllowedDistance = static_cast<float>(radius_m);
  navigate(&request);
}

std::vector<Vector2d> inMap(const mrpt::maps::CSimplePointsMap& points,
                            const mrpt::math::TPose2D& robot) {
  const Eigen::Rotation2Dd turn(robot.phi);
  std::vector<Vector2d> result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    float x = 0.f, y = 0.f, z = 0.f;
    points.getPoint(i, x, y, z);
    result.push_back(Vector2d(robot.x, robot.y) + turn * Vector2d(x, y));
  }
  return result;
}

double clearance(const RobotParams& robot, const mrpt::math::TPose2D& pose, const Vector2d& centre,
                 double radius) {
  const Vector2d local = Eigen::Rotation2Dd(-pose.phi) * (centre - Vector2d(pose.x, pose.y));
  const Vector2d half(0.5 * robot.length_m, 0.5 * robot.width_m);
  const Vector2d outside = (local.cwiseAbs() - half).cwiseMax(0.0);
  return std::max(0.0, outside.norm() - radius);
}

}  // namespace headway::app
