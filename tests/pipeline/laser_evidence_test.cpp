// SPDX-License-Identifier: BSD-3-Clause
#include "laser_evidence.h"

#include <gtest/gtest.h>

#include <cmath>

namespace headway::pipeline {
namespace {

/// A laser at (0.1, 0) m with the given height whose beams are 1 degree apart and meet a wall at
/// x = `wall` in the robot's frame.
LaserScan wallScan(double wall, double height = 0.2) {
  LaserScan scan;
  scan.label = "laser";
  scan.T_robot_laser.translation() = Eigen::Vector3d(0.1, 0.0, height);
  for (int degrees = -40; degrees <= 40; ++degrees) {
    const double angle = degrees * M_PI / 180.0;
    scan.ends.emplace_back(wall - 0.1, (wall - 0.1) * std::tan(angle));
  }
  return scan;
}

LaserScene sceneAt(const Pose& T_odom_robot = Pose::Identity()) {
  LaserScene scene;
  scene.T_odom_robot = T_odom_robot;
  scene.footprint = {0.5, 0.4};
  return scene;
}

struct Sorted {
  GroundScan scan;
  std::map<std::string, std::size_t> counts;
};

Sorted sorted(const LaserScan& laser, const LaserScene& scene,
              const std::vector<Track>& tracks = {}, GroundScan scan = {}) {
  Sorted result{std::move(scan), {}};
  addLaserScans({laser}, scene, tracks, {}, result.scan, result.counts);
  return result;
}

Track trackAt(const Eigen::Vector3d& place, const Eigen::Vector3d& velocity, MotionState state) {
  Track track;
  track.status = TrackStatus::kConfirmed;
  track.motion_state = state;
  track.position = place;
  track.velocity = velocity;
  track.size = {0.6, 0.6, 1.7};
  track.position_covariance = 1e-4 * Eigen::Matrix3d::Identity();
  return track;
}

TEST(LaserEvidenceTest, EndsAreObstaclesOnTheGround) {
  const auto result = sorted(wallScan(3.0), sceneAt());
  ASSERT_EQ(81u, result.scan.laser_obstacles.size());
  EXPECT_EQ(81u, result.counts.at("obstacles"));
  EXPECT_EQ(1u, result.counts.at("used"));
  for (const auto& obstacle : result.scan.laser_obstacles) {
    EXPECT_NEAR(3.0, obstacle.foot.x(), 1e-4);
    EXPECT_NEAR(0.0, obstacle.foot.z(), 1e-6);
  }
  EXPECT_TRUE(result.scan.free.empty()) << "a laser sees neither low obstacles nor drops";
  EXPECT_GE(result.scan.laser_passed.size(), 75u);
}

TEST(LaserEvidenceTest, TheSensorsPoseCounts) {
  LaserScan behind = wallScan(3.0);
  behind.T_robot_laser =
      Eigen::Translation3d(-0.2, 0.0, 0.2) * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ());
  const auto turned = sorted(behind, sceneAt());
  ASSERT_FALSE(turned.scan.laser_obstacles.empty());
  EXPECT_NEAR(-3.1, turned.scan.laser_obstacles.front().foot.x(), 1e-4);
}

TEST(LaserEvidenceTest, ATiltedLaserOnlyReportsWhatStands) {
  LaserScan tilted = wallScan(4.0, 0.4);
  tilted.T_robot_laser.linear() =
      Eigen::AngleAxisd(std::atan2(0.4, 2.0), Eigen::Vector3d::UnitY()).toRotationMatrix();
  const auto down = sorted(tilted, sceneAt());
  EXPECT_TRUE(down.scan.laser_obstacles.empty());
  EXPECT_EQ(81u, down.counts.at("on_ground"));
  EXPECT_TRUE(down.scan.laser_passed.empty()) << "it passed above obstacles at most";

  tilted.T_robot_laser.linear() =
      Eigen::AngleAxisd(-std::atan2(2.5, 4.0), Eigen::Vector3d::UnitY()).toRotationMatrix();
  const auto up = sorted(tilted, sceneAt());
  EXPECT_EQ(81u, up.counts.at("above_robot"));
}

TEST(LaserEvidenceTest, TheRobotItselfIsNoObstacle) {
  LaserScan laser = wallScan(3.0);
  laser.ends = {{0.1F, 0.0F}, {1.0F, 0.0F}};
  const auto result = sorted(laser, sceneAt());
  EXPECT_EQ(1u, result.counts.at("on_robot"));
  EXPECT_EQ(1u, result.scan.laser_obstacles.size());
}

TEST(LaserEvidenceTest, MovingObjectsAreLeftOutWhereTheyWereAtTheScan) {
  LaserScan laser = wallScan(3.0);
  laser.time = 10.2;
  LaserScene scene = sceneAt();
  scene.time = 10.0;
  const Eigen::Vector3d velocity(0.0, 2.0, 0.0);
  const auto moving = trackAt({3.0, -0.4, 0.85}, velocity, MotionState::kMoving);
  const auto result = sorted(laser, scene, {moving});
  EXPECT_GT(result.counts.at("on_moving_objects"), 5u);
  for (const auto& obstacle : result.scan.laser_obstacles) {
    EXPECT_GT(std::abs(obstacle.foot.y()), 0.5) << "at y = 0 when the laser scanned";
  }
  const auto standing = trackAt({3.0, 0.0, 0.85}, Eigen::Vector3d::Zero(), MotionState::kStatic);
  EXPECT_EQ(81u, sorted(laser, scene, {standing}).scan.laser_obstacles.size());
}

TEST(LaserEvidenceTest, ScansAreMovedToTheTimeOfTheFrame) {
  LaserScene scene = sceneAt();
  scene.time = 10.0;
  scene.T_previous_robot = Pose(Eigen::Translation3d(1.0, 0.0, 0.0));
  scene.interval_s = 0.1;  // 10 m/s
  LaserScan early = wallScan(3.0);
  early.time = 9.95;
  const auto result = sorted(early, scene);
  ASSERT_FALSE(result.scan.laser_obstacles.empty());
  EXPECT_NEAR(2.5, result.scan.laser_obstacles.front().foot.x(), 1e-4);

  scene.T_previous_robot = Pose(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()));
  LaserScan turning = wallScan(3.0);
  turning.ends = {{2.9F, 0.0F}};
  turning.time = 9.95;
  const auto turned = sorted(turning, scene);
  EXPECT_NEAR(-3.0 * std::sin(0.1), turned.scan.laser_obstacles.at(0).foot.y(), 1e-4);
}

TEST(LaserEvidenceTest, TheNearerObstacleEndsTheFreeGroundOfStereo) {
  GroundScan stereo;
  stereo.free.push_back({{1.0F, 0.0F, 0.0F}, {5.0F, 0.0F, 0.0F}});
  stereo.free.push_back({{3.5F, 0.01F, 0.0F}, {5.0F, 0.02F, 0.0F}});
  stereo.free.push_back({{0.0F, 1.0F, 0.0F}, {0.0F, 5.0F, 0.0F}});
  stereo.obstacles.push_back({{5.0F, 0.0F, 0.0F}, 0.1F});
  const auto result = sorted(wallScan(3.0), sceneAt(), {}, stereo);
  ASSERT_EQ(2u, result.scan.free.size());
  EXPECT_NEAR(3.0, result.scan.free[0].to.x(), 0.01);
  EXPECT_EQ(5.0F, result.scan.free[1].to.y()) << "the laser met nothing there";
  EXPECT_EQ(1u, result.scan.obstacles.size());
}

}  // namespace
}  // namespace headway::pipeline
