// SPDX-License-Identifier: BSD-3-Clause
// Obstacles of moving objects for any MRPT navigator: wraps the robot that it drives.
#include <headway/nav/predictive_obstacles.h>
#include <mrpt/core/Clock.h>
#include <mrpt/kinematics/CVehicleVelCmd_DiffDriven.h>
#include <mrpt/kinematics/CVehicleVelCmd_Holo.h>
#include <mrpt/maps/CSimplePointsMap.h>

#include <algorithm>
#include <cmath>
#include <exception>

namespace headway::nav {
namespace {

using Eigen::Vector2d;
using mrpt::kinematics::CVehicleVelCmd;

constexpr float kOccupiedBelow = 0.35f;  // probability of a cell to be free
constexpr double kStaticHeight = 1.8;    // of points in its occupied cells [m]

/// MRPT 2.5.8's duplicate() of a command aborts in a pure virtual method of its base class.
CVehicleVelCmd::Ptr copyOf(const CVehicleVelCmd& command) {
  const auto object = command.GetRuntimeClass()->createObject();
  const auto copy =
      std::dynamic_pointer_cast<CVehicleVelCmd>(std::shared_ptr<mrpt::rtti::CObject>(object));
  for (std::size_t i = 0; i < command.getVelCmdLength(); ++i) {
    const int index = static_cast<int>(i);
    copy->setVelCmdElement(index, command.getVelCmdElement(index));
  }
  return copy;
}

/// The motion that a command of a differential or holonomic robot causes; else nullopt.
std::optional<GroundTwist> twistOf(const CVehicleVelCmd& command) {
  using mrpt::kinematics::CVehicleVelCmd_DiffDriven;
  using mrpt::kinematics::CVehicleVelCmd_Holo;
  if (const auto* wheels = dynamic_cast<const CVehicleVelCmd_DiffDriven*>(&command)) {
    return GroundTwist{wheels->lin_vel, 0.0, wheels->ang_vel};
  }
  if (const auto* holonomic = dynamic_cast<const CVehicleVelCmd_Holo*>(&command)) {
    return GroundTwist{holonomic->vel * std::cos(holonomic->dir_local),
                       holonomic->vel * std::sin(holonomic->dir_local), holonomic->rot_speed};
  }
  return std::nullopt;
}

bool isFinite(const CVehicleVelCmd& command) {
  for (std::size_t i = 0; i < command.getVelCmdLength(); ++i) {
    if (!std::isfinite(command.getVelCmdElement(static_cast<int>(i)))) return false;
  }
  return true;
}

}  // namespace

std::string_view toString(SenseStatus status) {
  switch (status) {
    case SenseStatus::kSafe:
      return "safe";
    case SenseStatus::kInnerFailed:
      return "inner_failed";
    case SenseStatus::kNoPose:
      return "no_pose";
    case SenseStatus::kStaleMap:
      return "stale_map";
  }
  return "unknown";
}

PredictiveObstacles::PredictiveObstacles(mrpt::nav::CRobot2NavInterface& robot, MapSource map,
                                         const PredictiveObstaclesParams& params, Clock clock)
    : robot_(robot),
      map_(std::move(map)),
      clock_(clock ? std::move(clock) : Clock(&mrpt::Clock::nowDouble)),
      params_(params),
      memory_(params.caution * map::kLocalHold_s),
      moving_(params),
      governor_(params) {
  setLoggerName("PredictiveObstacles");
}

bool PredictiveObstacles::senseObstacles(mrpt::maps::CSimplePointsMap& obstacles,
                                         mrpt::system::TTimeStamp& timestamp) {
  report_ = SenseReport();
  if (!robot_.senseObstacles(obstacles, timestamp)) return false;
  report_.status =
      params_.policy == ObstaclePolicy::kStatic ? SenseStatus::kSafe : addPredictions(obstacles);
  if (report_.status != SenseStatus::kSafe) {
    MRPT_LOG_THROTTLE_ERROR_FMT(1.0, "obstacles are unsafe: %s (map is %.2f s old, limit %.2f s)",
                                std::string(toString(report_.status)).c_str(), report_.map_age_s,
                                params_.max_age_s);
  }
  return report_.status == SenseStatus::kSafe;
}

SenseStatus PredictiveObstacles::addPredictions(mrpt::maps::CSimplePointsMap& obstacles) {
  const auto snapshot = readMap();
  if (!snapshot) return SenseStatus::kStaleMap;
  const CMovingObjectsMap& layer = snapshot->movingObjects();
  report_.map_age_s = clock_() - layer.time();
  if (!(std::abs(report_.map_age_s) <= params_.max_age_s)) return SenseStatus::kStaleMap;

  const auto robot = locate(*snapshot);
  if (!robot) return SenseStatus::kNoPose;
  const auto query = queryOf(*snapshot);
  moving_.update(tracksOf(*snapshot, query), robot->place, std::max(0.0, report_.map_age_s));
  report_.moving_objects = moving_.current().size();
  removeLeaving(obstacles, *robot);
  insertPredicted(obstacles, *robot);
  insertLocal(obstacles, *robot, query);
  const auto grid = snapshot->staticGrid();
  if (params_.use_static_grid && grid) insertStatic(obstacles, *robot, *grid, query);
  return SenseStatus::kSafe;
}

std::vector<Track> PredictiveObstacles::tracksOf(const map::PerceptionMap& snapshot,
                                                 const map::MapQuery& query) {
  const CMovingObjectsMap& layer = snapshot.movingObjects();
  if (snapshot.local() == nullptr) return layer.tracks();
  return memory_.with(layer.tracks(), layer.time(), snapshot.odometryFrame(), query);
}

map::MapQuery PredictiveObstacles::queryOf(const map::PerceptionMap& snapshot) const {
  map::MapQueryParams params;
  params.max_age_s = params_.max_age_s;
  params.caution = params_.caution;
  return {snapshot, clock_(), params};
}

std::optional<GroundState> PredictiveObstacles::locate(const map::PerceptionMap& snapshot) {
  mrpt::math::TPose2D pose, odometry;
  mrpt::math::TTwist2D velocity;
  mrpt::system::TTimeStamp timestamp;
  std::string frame_id = params_.map_frame;
  if (!robot_.getCurrentPoseAndSpeeds(pose, velocity, timestamp, odometry, frame_id)) return {};
  bool is_finite = std::isfinite(velocity.vx) && std::isfinite(velocity.vy);
  for (const double value : {pose.x, pose.y, pose.phi, velocity.omega}) {
    is_finite = is_finite && std::isfinite(value);
  }
  const bool in_odometry = !params_.odom_frame.empty() && frame_id == params_.odom_frame;
  if (!is_finite || (frame_id != params_.map_frame && !in_odometry)) return {};
  velocity.rotate(-pose.phi);  // from the axes of its frame to the robot's
  if (in_odometry) {
    const Pose& T_map_odom = snapshot.odometryFrame();
    const Eigen::Vector3d place = T_map_odom * Eigen::Vector3d(pose.x, pose.y, 0.0);
    pose = {place.x(), place.y(), wrapAngle(pose.phi + yawOf(T_map_odom))};
  }
  return GroundState{{pose.x, pose.y}, pose.phi, {velocity.vx, velocity.vy, velocity.omega}};
}

std::optional<map::PerceptionMap> PredictiveObstacles::readMap() {
  try {
    return map_();
  } catch (const std::exception& error) {  // the robot must stop, whatever failed in perception
    MRPT_LOG_THROTTLE_ERROR_FMT(1.0, "the map cannot be read: %s", error.what());
    return std::nullopt;
  }
}

bool PredictiveObstacles::changeSpeeds(const CVehicleVelCmd& command) {
  command_ = copyOf(command);
  speed_ratio_ = admissibleSpeedRatio(command);
  if (speed_ratio_ >= 1.0) return robot_.changeSpeeds(command);
  const auto slowed = copyOf(command);
  if (speed_ratio_ > 0.0) {
    slowed->cmdVel_scale(speed_ratio_);
  } else {
    slowed->setToStop();  // the command may not be finite
  }
  return robot_.changeSpeeds(*slowed);
}

bool PredictiveObstacles::changeSpeedsNOP() {
  if (command_ == nullptr || (speed_ratio_ >= 1.0 && admissibleSpeedRatio(*command_) >= 1.0)) {
    return robot_.changeSpeedsNOP();
  }
  return changeSpeeds(*CVehicleVelCmd::Ptr(command_));
}

double PredictiveObstacles::admissibleSpeedRatio(const CVehicleVelCmd& command) {
  if (!isFinite(command)) return 0.0;
  if (params_.policy == ObstaclePolicy::kStatic) return 1.0;
  const auto snapshot = readMap();
  const auto robot = snapshot ? locate(*snapshot) : std::nullopt;
  if (!robot) return 0.0;
  const CMovingObjectsMap& layer = snapshot->movingObjects();
  const double age_s = clock_() - layer.time();
  if (!(std::abs(age_s) <= params_.max_age_s)) return 0.0;  // positions of objects are unknown
  if (!params_.governor.enabled || params_.policy != ObstaclePolicy::kTimeGated) return 1.0;
  const auto twist = twistOf(command);
  if (!twist) {
    MRPT_LOG_THROTTLE_ERROR(1.0,
                            "the motion that the command causes is unknown, so that the robot is "
                            "stopped; govern_speed = false forwards such commands");
    return 0.0;
  }
  const auto query = queryOf(*snapshot);
  SpeedGovernor::GroundNow ground;
  if (snapshot->local() != nullptr) {
    ground = [&query](const Vector2d& place, double within_s) {
      return query.groundNow(place, within_s);
    };
  }
  return governor_.speedRatio(*twist, *robot, tracksOf(*snapshot, query), std::max(0.0, age_s),
                              ground);
}

void PredictiveObstacles::removeLeaving(mrpt::maps::CSimplePointsMap& obstacles,
                                        const GroundState& robot) {
  const auto& xs = obstacles.getPointsBufferRef_x();
  const auto& ys = obstacles.getPointsBufferRef_y();
  const double c = std::cos(robot.yaw);
  const double s = std::sin(robot.yaw);
  std::vector<bool> gone(xs.size(), false);
  for (std::size_t i = 0; i < xs.size(); ++i) {
    const double x = xs[i];
    const double y = ys[i];
    gone[i] = moving_.leavesInTime(robot.place + Vector2d(c * x - s * y, s * x + c * y));
    if (gone[i]) ++report_.points_removed;
  }
  if (report_.points_removed > 0) obstacles.applyDeletionMask(gone);
}

void PredictiveObstacles::insertPredicted(mrpt::maps::CSimplePointsMap& obstacles,
                                          const GroundState& robot) {
  for (const auto& point : moving_.points()) {
    report_.points_added += insertUpright(obstacles, robot, point.place, {point.bottom, point.top});
  }
  obstacles.mark_as_modified();
}

void PredictiveObstacles::insertStatic(mrpt::maps::CSimplePointsMap& obstacles,
                                       const GroundState& robot,
                                       const mrpt::maps::COccupancyGridMap2D& grid,
                                       const map::MapQuery& query) {
  const double range = params_.max_range_m;
  const int left = std::max(0, grid.x2idx(static_cast<float>(robot.place.x() - range)));
  const int bottom = std::max(0, grid.y2idx(static_cast<float>(robot.place.y() - range)));
  const int right = std::min(static_cast<int>(grid.getSizeX()) - 1,
                             grid.x2idx(static_cast<float>(robot.place.x() + range)));
  const int top = std::min(static_cast<int>(grid.getSizeY()) - 1,
                           grid.y2idx(static_cast<float>(robot.place.y() + range)));
  for (int row = bottom; row <= top; ++row) {
    for (int column = left; column <= right; ++column) {
      if (grid.getCell(column, row) > kOccupiedBelow) continue;
      const Vector2d place(static_cast<double>(grid.idx2x(column)),
                           static_cast<double>(grid.idx2y(row)));
      const double distance = (place - robot.place).norm();
      if (distance < params_.robot.radius_m || distance > range) continue;
      if (query.localAt(place) == map::LocalState::kFree) continue;
      report_.static_points += insertUpright(obstacles, robot, place, {0.0, kStaticHeight});
    }
  }
  obstacles.mark_as_modified();
}

void PredictiveObstacles::insertLocal(mrpt::maps::CSimplePointsMap& obstacles,
                                      const GroundState& robot, const map::MapQuery& query) {
  for (const Vector2d& place : query.blockedNow()) {
    const double distance = (place - robot.place).norm();
    if (distance < params_.robot.radius_m || distance > params_.max_range_m) continue;
    if (moving_.leavesInTime(place)) continue;
    report_.local_points += insertUpright(obstacles, robot, place, {0.0, kStaticHeight});
  }
  obstacles.mark_as_modified();
}

std::size_t PredictiveObstacles::insertUpright(mrpt::maps::CSimplePointsMap& obstacles,
                                               const GroundState& robot, const Vector2d& place,
                                               const Extent& heights) const {
  const double c = std::cos(robot.yaw);
  const double s = std::sin(robot.yaw);
  const Vector2d offset = place - robot.place;
  const auto x = static_cast<float>(c * offset.x() + s * offset.y());
  const auto y = static_cast<float>(c * offset.y() - s * offset.x());
  const double height = heights.top - heights.bottom;
  const int layers = std::max(1, static_cast<int>(std::ceil(height / params_.layer_spacing_m)));
  for (int i = 0; i < layers; ++i) {
    obstacles.insertPointFast(x, y,
                              static_cast<float>(heights.bottom + height * (i + 0.5) / layers));
  }
  return static_cast<std::size_t>(layers);
}

}  // namespace headway::nav
