#pragma once

#include <headway/map/perception_map.h>
#include <headway/nav/moving_obstacles.h>
#include <headway/nav/speed_governor.h>
#include <mrpt/nav/reactive/CRobot2NavInterface.h>

#include <functional>
#include <optional>
#include <string_view>

namespace headway::nav {

/// How one call of senseObstacles() ended.
enum class SenseStatus {
  kSafe,         ///< the obstacles can be trusted
  kInnerFailed,  ///< the wrapped robot could not sense
  kNoPose,       ///< the wrapped robot does not know where it is, or not in the map's frame
  kStaleMap,     ///< the map is older than max_age_s, was never filled, or is from the future
};

/// "safe", "inner_failed", "no_pose", "stale_map".
[[nodiscard]] std::string_view toString(SenseStatus status);

/// What one call of senseObstacles() did.
struct SenseReport {
  SenseStatus status = SenseStatus::kInnerFailed;
  double map_age_s = 0.0;          ///< meaningless unless the map was asked
  std::size_t moving_objects = 0;  ///< tracks that move and were considered
  std::size_t points_added = 0;    ///< of predicted places
  std::size_t points_removed = 0;  ///< of bodies that will have left
};

/// Gives any MRPT navigator obstacles that know the future.
///
/// Wraps the robot's own interface and forwards everything to it. senseObstacles() adds, in the
/// robot's frame, the places where moving tracks may be when the robot could be there, and takes
/// away the sensed points of moving objects that will have left before the robot can arrive.
/// Sensing fails, and MRPT stops the robot, where the map is too old or the robot's place in it is
/// not known.
///
/// The map is read through a function that returns a snapshot, once a call and from the calling
/// thread: whoever writes the map guards that copy. The robot wrapped must outlive this.
///
///     headway::nav::PredictiveObstacles seeing(robot, [&] { return perception.map(); }, params);
///     mrpt::nav::CReactiveNavigationSystem navigator(seeing);
class PredictiveObstacles : public mrpt::nav::CRobot2NavInterface {
 public:
  using MapSource = std::function<map::PerceptionMap()>;
  using Clock = std::function<Time()>;

  /// @param clock  tells the time in which the map is dated; empty: mrpt::Clock
  PredictiveObstacles(mrpt::nav::CRobot2NavInterface& robot, MapSource map,
                      const PredictiveObstaclesParams& params, Clock clock = {});

  /// @return false if the obstacles cannot be trusted; lastReport() says why
  bool senseObstacles(mrpt::maps::CSimplePointsMap& obstacles,
                      mrpt::system::TTimeStamp& timestamp) override;

  /// What the last call of senseObstacles() did. For the thread that calls it.
  [[nodiscard]] const SenseReport& lastReport() const { return report_; }

  /// Hands the command on, slowed as SpeedGovernor says (policy kTimeGated). A command of a kind
  /// that is neither differential nor holonomic goes on as it is.
  bool changeSpeeds(const mrpt::kinematics::CVehicleVelCmd& command) override;
  /// Looks at the command under way again.
  bool changeSpeedsNOP() override;

  /// Share of the last command that was driven, 0 to 1.
  [[nodiscard]] double lastShare() const { return share_; }

  // All the rest goes to the wrapped robot.
  bool getCurrentPoseAndSpeeds(mrpt::math::TPose2D& pose, mrpt::math::TTwist2D& velocity,
                               mrpt::system::TTimeStamp& timestamp, mrpt::math::TPose2D& odometry,
                               std::string& frame_id) override;
  bool stop(bool is_emergency) override;
  mrpt::kinematics::CVehicleVelCmd::Ptr getEmergencyStopCmd() override;
  mrpt::kinematics::CVehicleVelCmd::Ptr getStopCmd() override;
  mrpt::kinematics::CVehicleVelCmd::Ptr getAlignCmd(double relative_heading) override;
  bool startWatchdog(float period_ms) override;
  bool stopWatchdog() override;
  void sendNavigationStartEvent() override;
  void sendNavigationEndEvent() override;
  void sendWaypointReachedEvent(int index, bool reached) override;
  void sendNewWaypointTargetEvent(int index) override;
  void sendNavigationEndDueToErrorEvent() override;
  void sendWaySeemsBlockedEvent() override;
  void sendApparentCollisionEvent() override;
  void sendCannotGetCloserToBlockedTargetEvent() override;
  double getNavigationTime() override;
  void resetNavigationTimer() override;

 private:
  /// The robot's pose in the map's frame; nullopt where it does not know it.
  [[nodiscard]] std::optional<GroundState> locate();
  [[nodiscard]] double admissibleShare(const mrpt::kinematics::CVehicleVelCmd& command);
  [[nodiscard]] SenseStatus addPredictions(mrpt::maps::CSimplePointsMap& obstacles);
  void removeGone(mrpt::maps::CSimplePointsMap& obstacles, const GroundState& robot);
  void insertPredicted(mrpt::maps::CSimplePointsMap& obstacles, const GroundState& robot);

  mrpt::nav::CRobot2NavInterface& robot_;
  MapSource map_;
  Clock clock_;
  PredictiveObstaclesParams params_;
  MovingObstacles moving_;
  SpeedGovernor governor_;
  SenseReport report_;
  mrpt::kinematics::CVehicleVelCmd::Ptr command_;  ///< the planner's last one; null: stopped
  double share_ = 1.0;                             ///< of it that is driven
};

}  // namespace headway::nav
