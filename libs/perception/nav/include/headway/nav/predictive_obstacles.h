// SPDX-License-Identifier: BSD-3-Clause
// Obstacles of moving objects for any MRPT navigator: wraps the robot that it drives.
#pragma once

#include <headway/map/map_query.h>
#include <headway/map/perception_map.h>
#include <headway/nav/moving_obstacles.h>
#include <headway/nav/speed_governor.h>
#include <mrpt/nav/reactive/CRobot2NavInterface.h>

#include <functional>
#include <optional>
#include <string_view>

namespace headway::nav {

/// Outcome of one call of senseObstacles().
enum class SenseStatus {
  kSafe,         ///< the obstacles are valid
  kInnerFailed,  ///< the wrapped robot could not sense
  kNoPose,       ///< the wrapped robot has no pose, or none in the map's frame
  kStaleMap,     ///< the map is older than max_age_s, empty, dated in the future, or not readable
};

/// "safe", "inner_failed", "no_pose", "stale_map".
[[nodiscard]] std::string_view toString(SenseStatus status);

/// Statistics of one call of senseObstacles().
struct SenseReport {
  SenseStatus status = SenseStatus::kInnerFailed;
  double map_age_s = 0.0;          ///< 0 if the map was not read
  std::size_t moving_objects = 0;  ///< moving tracks that were considered
  std::size_t points_added = 0;    ///< at predicted places
  std::size_t static_points = 0;   ///< in occupied cells of the map's grid
  std::size_t local_points = 0;    ///< where something stands now
  std::size_t points_removed = 0;  ///< of objects that leave in time
};

/// Adds predicted obstacles to the sensing of any MRPT navigator.
///
/// Wraps the robot's own interface and forwards all calls to it. senseObstacles() adds, in the
/// robot's frame, the predicted places of moving tracks at the times at which the robot could be
/// there, and removes the sensed points of moving objects that leave before the robot arrives. It
/// also adds what the camera's newest frames show to be blocked (see map::LocalLayer), and the
/// occupied cells of the map's grid that they do not show to be free: obstacles that the robot's
/// sensors may not see.
/// Sensing fails, and MRPT stops the robot, if the map is too old or the robot's pose is unknown.
///
/// The map is read through a function that returns a snapshot, once per call and in the calling
/// thread; the function must be safe against concurrent writers. If it throws, the map counts as
/// stale. The wrapped robot must outlive this object.
///
///     headway::nav::PredictiveObstacles predictive(robot, [&] { return perception.map(); },
///     params); mrpt::nav::CReactiveNavigationSystem navigator(predictive);
class PredictiveObstacles : public mrpt::nav::CRobot2NavInterface {
 public:
  using MapSource = std::function<map::PerceptionMap()>;
  using Clock = std::function<Time()>;

  /// @param clock  returns the current time in the map's clock [s]; empty: mrpt::Clock
  /// @throws       InputError if a parameter is out of range
  PredictiveObstacles(mrpt::nav::CRobot2NavInterface& robot, MapSource map,
                      const PredictiveObstaclesParams& params, Clock clock = {});

  /// @return false if the obstacles are invalid; lastReport() holds the reason
  bool senseObstacles(mrpt::maps::CSimplePointsMap& obstacles,
                      mrpt::system::TTimeStamp& timestamp) override;

  /// Statistics of the last senseObstacles(), for the thread that calls it.
  [[nodiscard]] const SenseReport& lastReport() const { return report_; }

  /// Forwards the command, scaled by SpeedGovernor (policy kTimeGated), so that the robot can stop
  /// on ground that is free now, or a stop.
  ///
  /// A stop if the command is not finite; with a policy that reads the map, if the map cannot be
  /// read or is too old, or the robot's pose in it is unknown; and with the governor, if the robot
  /// is neither differential nor holonomic, so that the commanded motion is unknown.
  bool changeSpeeds(const mrpt::kinematics::CVehicleVelCmd& command) override;
  /// Evaluates the current command again and forwards it.
  bool changeSpeedsNOP() override;

  /// The ratio of a command's speed that changeSpeeds() would forward now, 0 to 1.
  [[nodiscard]] double admissibleSpeedRatio(const mrpt::kinematics::CVehicleVelCmd& command);

  /// Ratio of the forwarded to the last commanded speed, 0 to 1.
  [[nodiscard]] double lastSpeedRatio() const { return speed_ratio_; }

  // Forwarded to the wrapped robot.
  bool getCurrentPoseAndSpeeds(mrpt::math::TPose2D& pose, mrpt::math::TTwist2D& velocity,
                               mrpt::system::TTimeStamp& timestamp, mrpt::math::TPose2D& odometry,
                               std::string& frame_id) override {
    return robot_.getCurrentPoseAndSpeeds(pose, velocity, timestamp, odometry, frame_id);
  }
  bool stop(bool is_emergency) override {
    command_.reset();
    return robot_.stop(is_emergency);
  }
  mrpt::kinematics::CVehicleVelCmd::Ptr getEmergencyStopCmd() override {
    return robot_.getEmergencyStopCmd();
  }
  mrpt::kinematics::CVehicleVelCmd::Ptr getStopCmd() override { return robot_.getStopCmd(); }
  mrpt::kinematics::CVehicleVelCmd::Ptr getAlignCmd(double relative_heading) override {
    return robot_.getAlignCmd(relative_heading);
  }
  bool startWatchdog(float period_ms) override { return robot_.startWatchdog(period_ms); }
  bool stopWatchdog() override { return robot_.stopWatchdog(); }
  void sendNavigationStartEvent() override { robot_.sendNavigationStartEvent(); }
  void sendNavigationEndEvent() override { robot_.sendNavigationEndEvent(); }
  void sendWaypointReachedEvent(int index, bool reached) override {
    robot_.sendWaypointReachedEvent(index, reached);
  }
  void sendNewWaypointTargetEvent(int index) override { robot_.sendNewWaypointTargetEvent(index); }
  void sendNavigationEndDueToErrorEvent() override { robot_.sendNavigationEndDueToErrorEvent(); }
  void sendWaySeemsBlockedEvent() override { robot_.sendWaySeemsBlockedEvent(); }
  void sendApparentCollisionEvent() override { robot_.sendApparentCollisionEvent(); }
  void sendCannotGetCloserToBlockedTargetEvent() override {
    robot_.sendCannotGetCloserToBlockedTargetEvent();
  }
  double getNavigationTime() override { return robot_.getNavigationTime(); }
  void resetNavigationTimer() override { robot_.resetNavigationTimer(); }

 private:
  /// The map; nullopt, and logged, if its source throws.
  [[nodiscard]] std::optional<map::PerceptionMap> readMap();
  [[nodiscard]] map::MapQuery queryOf(const map::PerceptionMap& snapshot) const;
  /// The tracks of the map and, where it shows what is free now, those that have left the view.
  [[nodiscard]] std::vector<Track> tracksOf(const map::PerceptionMap& snapshot,
                                            const map::MapQuery& query);
  /// The robot in the map's frame; nullopt if its pose is unknown.
  [[nodiscard]] std::optional<GroundState> locate(const map::PerceptionMap& snapshot);
  [[nodiscard]] SenseStatus addPredictions(mrpt::maps::CSimplePointsMap& obstacles);
  void removeLeaving(mrpt::maps::CSimplePointsMap& obstacles, const GroundState& robot);
  void insertPredicted(mrpt::maps::CSimplePointsMap& obstacles, const GroundState& robot);
  void insertStatic(mrpt::maps::CSimplePointsMap& obstacles, const GroundState& robot,
                    const mrpt::maps::COccupancyGridMap2D& grid, const map::MapQuery& query);
  void insertLocal(mrpt::maps::CSimplePointsMap& obstacles, const GroundState& robot,
                   const map::MapQuery& query);

  struct Extent {
    double bottom;  ///< above ground [m]
    double top;
  };
  /// Inserts points above a place of the map. @return  their number
  std::size_t insertUpright(mrpt::maps::CSimplePointsMap& obstacles, const GroundState& robot,
                            const Eigen::Vector2d& place, const Extent& heights) const;

  mrpt::nav::CRobot2NavInterface& robot_;
  MapSource map_;
  Clock clock_;
  PredictiveObstaclesParams params_;
  TrackMemory memory_;
  MovingObstacles moving_;
  SpeedGovernor governor_;
  SenseReport report_;
  mrpt::kinematics::CVehicleVelCmd::Ptr command_;  ///< the planner's last command; null: stopped
  double speed_ratio_ = 1.0;                       ///< of it that is forwarded
};

}  // namespace headway::nav
