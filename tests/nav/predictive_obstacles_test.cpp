// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/nav/predictive_obstacles.h>
#include <headway_test/walking_track.h>
#include <mrpt/kinematics/CVehicleVelCmd_DiffDriven.h>

#include <atomic>
#include <functional>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "scripted_robot.h"

namespace headway::nav {

/// A command of a kind that the governor does not know.
class RudderCommand : public mrpt::kinematics::CVehicleVelCmd {
  DEFINE_SERIALIZABLE(RudderCommand, headway::nav)

 public:
  size_t getVelCmdLength() const override { return 1; }
  std::string getVelCmdDescription(int /*index*/) const override { return "power"; }
  double getVelCmdElement(int /*index*/) const override { return power; }
  void setVelCmdElement(int /*index*/, double value) override { power = value; }
  bool isStopCmd() const override { return power == 0.0; }
  void setToStop() override { power = 0.0; }
  void cmdVel_scale(double scale) override { power *= scale; }
  double cmdVel_limits(const CVehicleVelCmd& /*before*/, double /*beta*/,
                       const TVelCmdParams& /*params*/) override {
    return 1.0;
  }

  double power = 1.0;
};

uint8_t RudderCommand::serializeGetVersion() const { return 0; }
void RudderCommand::serializeTo(mrpt::serialization::CArchive& /*out*/) const {}
void RudderCommand::serializeFrom(mrpt::serialization::CArchive& /*in*/, uint8_t /*version*/) {}

}  // namespace headway::nav

using mrpt::kinematics::CVehicleVelCmd;
IMPLEMENTS_SERIALIZABLE(RudderCommand, CVehicleVelCmd, headway::nav)

namespace headway::nav {
namespace {

using mrpt::maps::CSimplePointsMap;
using test::walkingTrack;

class PredictiveObstaclesTest : public testing::Test {
 protected:
  PredictiveObstaclesTest() {
    wheels_.setCurrentGTPose({10.0, 5.0, M_PI / 2.0});  // faces along the map's y
    map_.update(100.0, {});
    now_ = 100.1;
  }

  bool sense(ObstaclePolicy policy = ObstaclePolicy::kTimeGated) {
    PredictiveObstaclesParams params;
    params.policy = policy;
    params.steer_horizon_s = 3.0;
    PredictiveObstacles obstacles(
        robot_, [this] { return map_; }, params, [this] { return now_; });
    obstacles.setMinLoggingLevel(mrpt::system::LVL_ERROR);
    mrpt::system::TTimeStamp timestamp;
    const bool safe = obstacles.senseObstacles(points_, timestamp);
    report_ = obstacles.lastReport();
    return safe;
  }

  /// A person who crosses the robot's path from the right and meets it 2 m ahead.
  [[nodiscard]] static Track meetingTrack() { return walkingTrack(1, {12.0, 7.0}, {-1.0, 0.0}); }

  static mrpt::kinematics::CVehicleVelCmd_DiffDriven fullSpeed() {
    mrpt::kinematics::CVehicleVelCmd_DiffDriven command;
    command.lin_vel = 1.0;
    return command;
  }

  bool anyPointNear(double x, double y, double radius) const {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      float px = 0.f, py = 0.f, pz = 0.f;
      points_.getPoint(i, px, py, pz);
      if (std::hypot(px - x, py - y) < radius) return true;
    }
    return false;
  }

  mrpt::kinematics::CVehicleSimul_DiffDriven wheels_;
  ScriptedRobot robot_{wheels_};
  map::PerceptionMap map_;
  double now_ = 0.0;
  CSimplePointsMap points_;
  SenseReport report_;
};

TEST_F(PredictiveObstaclesTest, AddsTheMeetingPlaceInTheRobotsFrame) {
  map_.update(100.0, {meetingTrack()});
  ASSERT_TRUE(sense());
  EXPECT_TRUE(anyPointNear(2.0, 0.0, 0.5));
  EXPECT_EQ(report_.moving_objects, 1u);
  EXPECT_EQ(report_.points_added, points_.size());
}

TEST_F(PredictiveObstaclesTest, AddsOccupiedCellsOfTheGrid) {
  auto grid = mrpt::maps::COccupancyGridMap2D::Create(0.0f, 20.0f, 0.0f, 20.0f, 0.2f);
  grid->setPos(10.1f, 7.1f, 0.1f);   // 2.1 m ahead
  grid->setPos(10.1f, 5.1f, 0.1f);   // where the robot is
  grid->setPos(12.1f, 5.1f, 0.45f);  // not certain
  map_.update(grid);
  ASSERT_TRUE(sense());
  EXPECT_TRUE(anyPointNear(2.1, -0.1, 0.05));
  EXPECT_FALSE(anyPointNear(0.1, -0.1, 0.3));
  EXPECT_FALSE(anyPointNear(0.1, -2.1, 0.3));
  EXPECT_EQ(report_.static_points, points_.size());
  points_.clear();
  ASSERT_TRUE(sense(ObstaclePolicy::kStatic));
  EXPECT_EQ(0u, points_.size()) << "the map is not read";
}

TEST_F(PredictiveObstaclesTest, WhatIsSeenNowComesBeforeTheGrid) {
  // The robot is at (10, 5) and faces along y, as the odometry frame's x does.
  StereoCamera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 300.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.baseline_m = 0.1;
  camera.T_robot_cam.translation().z() = 0.5;
  map::LocalLayer layer(5.0);
  GroundScan scan;
  for (int i = -40; i <= 40; ++i) {
    const float slope = 0.01F * static_cast<float>(i);
    scan.free.push_back({{1.0F, slope, 0.0F}, {4.0F, 4.0F * slope, 0.0F}});
  }
  for (int i = 0; i < 4; ++i) scan.obstacles.push_back({{2.0F, -0.5F, 0.0F}, 0.02F});
  for (int i = 0; i < 4; ++i) layer.add(99.7 + 0.1 * i, Pose::Identity(), scan, camera);
  Pose T_map_odom(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitZ()));
  T_map_odom.translation() << 10.0, 5.0, 0.0;
  map_.update(100.0, {}, T_map_odom);
  map_.update(std::make_shared<const map::LocalLayer>(layer));
  const auto grid = mrpt::maps::COccupancyGridMap2D::Create(0.0F, 20.0F, 0.0F, 20.0F, 0.2F);
  grid->fill(0.9F);
  grid->setPos(10.0F, 8.0F, 0.05F);  // 3 m ahead, seen to be free now
  grid->setPos(10.0F, 3.0F, 0.05F);  // 2 m behind
  map_.update(grid);
  ASSERT_TRUE(sense());
  EXPECT_GT(report_.local_points, 0U);
  EXPECT_EQ(report_.static_points, 3U) << "the one behind, at three heights";
  bool is_there = false;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    float x = 0.0F, y = 0.0F;
    points_.getPoint(i, x, y);
    is_there = is_there || std::hypot(x - 2.0F, y + 0.5F) < 0.15F;
    EXPECT_GT(std::hypot(x - 3.0F, y), 0.3F);
  }
  EXPECT_TRUE(is_there);
}

TEST_F(PredictiveObstaclesTest, HasPointsAtAllHeightsOfAnObject) {
  map_.update(100.0, {meetingTrack()});
  ASSERT_TRUE(sense());
  bool low = false, high = false;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    float x = 0.f, y = 0.f, z = 0.f;
    points_.getPoint(i, x, y, z);
    EXPECT_GT(z, 0.0f);
    EXPECT_LT(z, 1.7f);
    low = low || z < 0.5f;
    high = high || z > 1.2f;
  }
  EXPECT_TRUE(low && high);
}

TEST_F(PredictiveObstaclesTest, RemovesPointsOfAnObjectThatLeavesInTime) {
  robot_.sensed = {{3.0, 0.0}, {3.0, -2.0}};
  map_.update(100.0, {walkingTrack(1, {10.0, 8.25}, {1.5, 0.0})});
  ASSERT_TRUE(sense());
  EXPECT_EQ(report_.points_removed, 1u);
  EXPECT_FALSE(anyPointNear(3.0, 0.0, 0.05));
  EXPECT_TRUE(anyPointNear(3.0, -2.0, 0.05));
}

TEST_F(PredictiveObstaclesTest, StaticForwardsThePointsOfNowAndNeedsNoMap) {
  robot_.sensed = {{3.0, 0.0}};
  map_.update(100.0, {meetingTrack()});
  now_ = 1000.0;
  ASSERT_TRUE(sense(ObstaclePolicy::kStatic));
  EXPECT_EQ(points_.size(), 1u);
}

TEST_F(PredictiveObstaclesTest, AMapWithoutTracksAddsNothing) {
  robot_.sensed = {{3.0, 0.0}};
  ASSERT_TRUE(sense());
  EXPECT_EQ(points_.size(), 1u);
}

TEST_F(PredictiveObstaclesTest, ARobotFarFromAllTracksKeepsItsOwnPoints) {
  robot_.sensed = {{3.0, 0.0}};
  map_.update(100.0, {meetingTrack()});
  wheels_.setCurrentGTPose({-1e5, 1e5, 0.0});
  ASSERT_TRUE(sense());
  EXPECT_EQ(points_.size(), 1u);
}

TEST_F(PredictiveObstaclesTest, AStaleMapIsUnsafe) {
  now_ = 100.6;
  EXPECT_FALSE(sense());
  EXPECT_EQ(report_.status, SenseStatus::kStaleMap);
  EXPECT_NEAR(report_.map_age_s, 0.6, 1e-9);
}

TEST_F(PredictiveObstaclesTest, AnEmptyMapOrOneOfTheFutureIsUnsafe) {
  map_ = map::PerceptionMap();
  EXPECT_FALSE(sense());
  EXPECT_EQ(report_.status, SenseStatus::kStaleMap);
  map_.update(101.0, {});
  EXPECT_FALSE(sense());
  EXPECT_EQ(report_.status, SenseStatus::kStaleMap);
}

TEST_F(PredictiveObstaclesTest, ARobotThatIsLostIsUnsafe) {
  robot_.knows_pose = false;
  EXPECT_FALSE(sense());
  EXPECT_EQ(report_.status, SenseStatus::kNoPose);
  robot_.knows_pose = true;
  robot_.pose_is_nan = true;
  EXPECT_FALSE(sense());
  EXPECT_EQ(report_.status, SenseStatus::kNoPose);
  robot_.pose_is_nan = false;
  robot_.frame = "odom";
  EXPECT_FALSE(sense());
  EXPECT_EQ(report_.status, SenseStatus::kNoPose);
}

TEST_F(PredictiveObstaclesTest, ARobotThatCannotSenseIsUnsafe) {
  robot_.can_sense = false;
  EXPECT_FALSE(sense());
  EXPECT_EQ(report_.status, SenseStatus::kInnerFailed);
}

TEST_F(PredictiveObstaclesTest, ForwardsAllOtherCalls) {
  PredictiveObstacles obstacles(robot_, [this] { return map_; }, {});
  obstacles.changeSpeeds(mrpt::kinematics::CVehicleVelCmd_DiffDriven());
  obstacles.stop(true);
  EXPECT_EQ(robot_.stops, 1);
  EXPECT_TRUE(obstacles.getStopCmd()->isStopCmd());
  wheels_.simulateOneTimeStep(0.5);
  EXPECT_NEAR(obstacles.getNavigationTime(), robot_.getNavigationTime(), 1e-12);
}

TEST_F(PredictiveObstaclesTest, SlowsACommandThatWouldCauseAContact) {
  PredictiveObstaclesParams params;
  PredictiveObstacles obstacles(
      robot_, [this] { return map_; }, params, [this] { return now_; });
  obstacles.changeSpeeds(fullSpeed());
  EXPECT_EQ(obstacles.lastSpeedRatio(), 1.0);
  map_.update(100.0, {walkingTrack(1, {11.5, 6.5}, {-1.0, 0.0}, 0.1)});
  obstacles.changeSpeedsNOP();  // evaluates the same command again
  EXPECT_LT(obstacles.lastSpeedRatio(), 1.0);
  map_.update(100.0, {});
  obstacles.changeSpeedsNOP();
  EXPECT_EQ(obstacles.lastSpeedRatio(), 1.0) << "the path is free";
  wheels_.simulateOneTimeStep(3.0);
  EXPECT_NEAR(wheels_.getCurrentGTVelLocal().vx, 1.0, 0.05) << "the command went on as it was";
}

TEST_F(PredictiveObstaclesTest, StopsTheRobotIfTheMapIsStale) {
  PredictiveObstacles obstacles(
      robot_, [this] { return map_; }, {}, [this] { return now_; });
  now_ = 101.0;
  obstacles.changeSpeeds(fullSpeed());
  EXPECT_EQ(obstacles.lastSpeedRatio(), 0.0);
  wheels_.simulateOneTimeStep(3.0);
  EXPECT_NEAR(wheels_.getCurrentGTVelLocal().vx, 0.0, 0.05);
}

/// A robot that remembers its last command.
class ObedientRobot : public ScriptedRobot {
 public:
  using ScriptedRobot::ScriptedRobot;
  bool changeSpeeds(const mrpt::kinematics::CVehicleVelCmd& command) override {
    is_stopped = command.isStopCmd();
    return true;
  }
  bool is_stopped = false;
};

class FailSafeTest : public PredictiveObstaclesTest {
 protected:
  /// Whether a command reaches the robot as a stop.
  bool stops(const mrpt::kinematics::CVehicleVelCmd& command, ObstaclePolicy policy,
             bool governed = true) {
    PredictiveObstaclesParams params;
    params.policy = policy;
    params.governor.enabled = governed;
    PredictiveObstacles obstacles(
        robot_, [this] { return source_(); }, params, [this] { return now_; });
    obstacles.setMinLoggingLevel(mrpt::system::LVL_ERROR);
    obstacles.logging_enable_console_output = false;
    obstacles.changeSpeeds(command);
    return robot_.is_stopped;
  }

  /// With every policy that reads the map, governed or not.
  bool stopsAlways() {
    for (const auto policy : {ObstaclePolicy::kSweep, ObstaclePolicy::kTimeGated}) {
      for (const bool governed : {true, false}) {
        if (!stops(fullSpeed(), policy, governed)) return false;
      }
    }
    return true;
  }

  ObedientRobot robot_{wheels_};
  std::function<map::PerceptionMap()> source_ = [this] { return map_; };
};

TEST_F(FailSafeTest, DrivesWhileAllIsKnown) {
  EXPECT_FALSE(stops(fullSpeed(), ObstaclePolicy::kTimeGated));
  EXPECT_FALSE(stops(fullSpeed(), ObstaclePolicy::kSweep));
}

TEST_F(FailSafeTest, AnUnknownPoseOrSpeedStopsTheRobot) {
  robot_.knows_pose = false;
  EXPECT_TRUE(stopsAlways());
  robot_.knows_pose = true;
  robot_.pose_is_nan = true;
  EXPECT_TRUE(stopsAlways());
  robot_.pose_is_nan = false;
  robot_.frame = "odom";
  EXPECT_TRUE(stopsAlways());
}

TEST_F(FailSafeTest, AStaleMapOrOneThatCannotBeReadStopsTheRobot) {
  now_ = 101.0;
  EXPECT_TRUE(stopsAlways());
  now_ = 99.0;
  EXPECT_TRUE(stopsAlways()) << "the clock went back";
  now_ = 100.1;
  EXPECT_FALSE(stopsAlways());
  map_ = map::PerceptionMap();
  EXPECT_TRUE(stopsAlways()) << "as published after an exception in perception";
  source_ = []() -> map::PerceptionMap { throw std::runtime_error("broken"); };
  EXPECT_TRUE(stopsAlways());
}

TEST_F(FailSafeTest, AnUnknownCommandStopsTheRobot) {
  auto command = fullSpeed();
  command.ang_vel = std::numeric_limits<double>::quiet_NaN();
  for (const auto policy :
       {ObstaclePolicy::kStatic, ObstaclePolicy::kSweep, ObstaclePolicy::kTimeGated}) {
    EXPECT_TRUE(stops(command, policy));
    EXPECT_TRUE(stops(command, policy, false));
  }
}

TEST_F(FailSafeTest, ACommandOfUnknownKindStopsTheRobotUnlessItIsNotGoverned) {
  EXPECT_TRUE(stops(RudderCommand(), ObstaclePolicy::kTimeGated));
  EXPECT_FALSE(stops(RudderCommand(), ObstaclePolicy::kTimeGated, false));
}

TEST_F(FailSafeTest, ObstaclesOfAMapThatCannotBeReadAreUnsafe) {
  PredictiveObstacles obstacles(
      robot_, []() -> map::PerceptionMap { throw std::runtime_error("broken"); }, {},
      [this] { return now_; });
  obstacles.logging_enable_console_output = false;
  mrpt::system::TTimeStamp timestamp;
  EXPECT_FALSE(obstacles.senseObstacles(points_, timestamp));
  EXPECT_EQ(obstacles.lastReport().status, SenseStatus::kStaleMap);
}

TEST_F(PredictiveObstaclesTest, LeavesTheSpeedAloneWhereItIsToldTo) {
  map_.update(100.0, {walkingTrack(1, {11.5, 6.5}, {-1.0, 0.0}, 0.1)});
  PredictiveObstaclesParams params;
  params.governor.enabled = false;
  PredictiveObstacles ungoverned(
      robot_, [this] { return map_; }, params, [this] { return now_; });
  ungoverned.changeSpeeds(fullSpeed());
  EXPECT_EQ(ungoverned.lastSpeedRatio(), 1.0);
  params.governor.enabled = true;
  params.policy = ObstaclePolicy::kStatic;
  PredictiveObstacles of_now(
      robot_, [this] { return map_; }, params, [this] { return now_; });
  of_now.changeSpeeds(fullSpeed());
  EXPECT_EQ(of_now.lastSpeedRatio(), 1.0);
}

TEST_F(PredictiveObstaclesTest, ReadsSnapshotsWhileAnotherThreadWritesTheMap) {
  std::mutex guard;
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (int i = 0; !done; ++i) {
      std::vector<Track> tracks;
      if (i % 3 != 0) tracks = {meetingTrack(), walkingTrack(2, {8.0, 7.0}, {1.0, 0.0})};
      const std::lock_guard lock(guard);
      map_.update(100.0, std::move(tracks));
      if (i % 7 == 0) map_ = map::PerceptionMap();  // a reset
    }
  });
  const auto snapshot = [&] {
    const std::lock_guard lock(guard);
    return map_;
  };
  PredictiveObstacles obstacles(robot_, snapshot, {}, [this] { return now_; });
  obstacles.setMinLoggingLevel(mrpt::system::LVL_ERROR);
  for (int i = 0; i < 500; ++i) {
    mrpt::system::TTimeStamp timestamp;
    const bool safe = obstacles.senseObstacles(points_, timestamp);
    const auto status = obstacles.lastReport().status;
    EXPECT_EQ(status, safe ? SenseStatus::kSafe : SenseStatus::kStaleMap);
  }
  done = true;
  writer.join();
}

}  // namespace
}  // namespace headway::nav
