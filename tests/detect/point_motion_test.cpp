// SPDX-License-Identifier: BSD-3-Clause
#include "point_motion.h"

#include <gtest/gtest.h>

#include <random>

#include "drive.h"

namespace headway::detect {
namespace {

using test::Drive;
using test::testCamera;

TEST(FitMotionTest, RecoversAVelocityWithinItsOwnUncertainty) {
  Drive drive;
  const Eigen::Vector3d velocity(1.0, 0.0, -3.0);
  int within = 0;
  for (int i = 0; i < 100; ++i) {
    const auto observations = drive.see({3, 0, 22}, velocity, 0.4);
    const auto motion = fitMotion(observations, drive.path, drive.camera, {}, 30.0);
    ASSERT_TRUE(motion);
    const Eigen::Vector3d off = motion->velocity - velocity;
    if (off.dot(motion->velocity_covariance.inverse() * off) < 7.81) ++within;  // 95 %
  }
  EXPECT_GT(within, 85);
}

/// A van beside the camera that turns and brakes: the bend of its path over the image is no motion
/// along the line of sight.
TEST(FitMotionTest, AnAccelerationIsNoMotionAlongTheLineOfSight) {
  Drive drive;
  const Eigen::Vector3d start(6.0, 0.0, 20.0), first(4.5, 0.0, 3.5), acceleration(-1.5, 0.0, 0.5);
  const Eigen::Vector3d last = first + 6.0 * test::kFrameStep * acceleration;
  Eigen::Vector3d off = Eigen::Vector3d::Zero(), steady_off = off;
  for (int i = 0; i < 100; ++i) {
    const auto observations = drive.see(start, first, 0.4, 0.0, 4.0, acceleration);
    const auto motion = fitMotion(observations, drive.path, drive.camera, {}, 30.0);
    ASSERT_TRUE(motion);
    EXPECT_LT(motion->movingFit(), kGoodFit);
    off += 0.01 * (motion->velocity - last);
    steady_off += 0.01 * (motion->steady_velocity - last);
  }
  EXPECT_LT(off.norm(), 0.35) << off.transpose();
  EXPECT_GT(steady_off.norm(), 3.0 * off.norm()) << steady_off.transpose();
}

TEST(FitMotionTest, AStillPointsLikelihoodRatioIsChiSquare) {
  Drive drive;
  double sum = 0.0;
  int beyond = 0;
  for (int i = 0; i < 300; ++i) {
    const auto motion =
        fitMotion(drive.see({-4, 0, 18}, {0, 0, 0}, 0.4), drive.path, drive.camera, {}, 30.0);
    ASSERT_TRUE(motion);
    const double gain = motion->static_error - motion->moving_error;
    sum += gain;
    if (gain > 30.0) ++beyond;
  }
  EXPECT_NEAR(sum / 300, 3.0, 0.8) << "3 degrees of freedom";
  EXPECT_EQ(beyond, 0);
}

TEST(FitMotionTest, SaysNothingOfASinglePlaceOrBehindTheCamera) {
  Drive drive;
  auto observations = drive.see({0, 0, 20}, {0, 0, 0}, 0.0);
  EXPECT_FALSE(fitMotion({observations.back()}, drive.path, drive.camera, {}, 30.0));
  observations.back().uvd.z() = -1.0;
  EXPECT_FALSE(fitMotion(observations, drive.path, drive.camera, {}, 30.0));
}

TEST(CameraPathTest, RefiningUndoesASmallTurn) {
  const StereoCamera camera = testCamera();
  CameraPath path(camera, 0.5);
  path.advance(0.0, Pose::Identity());
  Pose turned = Pose::Identity();
  turned.linear() = expSo3({0.0, 0.002, 0.0});
  path.advance(0.1, turned);  // the camera has not turned at all
  std::vector<StaticObservation> points;
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d point(-10 + i % 10 * 2.0, -1 + i % 3, 12 + i % 7 * 4.0);
    points.push_back({point, *project(point, camera)});
  }
  EXPECT_EQ(path.refine(points), 1.0);
  EXPECT_LT(logSo3(path.T_cam_world(1).linear()).norm(), 1e-4);
}

TEST(CameraPathTest, FollowsAHardBrake) {
  CameraPath path(testCamera(), 0.5);
  const double places[] = {0.0, 1.5, 3.0, 4.4, 5.7, 6.9};  // 15 m/s, then 10 m/s^2 less
  for (int i = 0; i < 6; ++i) {
    Pose pose = Pose::Identity();
    pose.translation().z() = places[i];
    path.advance(0.1 * i, pose);
  }
  EXPECT_NEAR(-6.9, path.T_cam_world(5).translation().z(), 1e-9);
}

TEST(CameraPathTest, WithoutPointsThereIsNothingToRefineBy) {
  CameraPath path(testCamera(), 0.5);
  path.advance(0.0, Pose::Identity());
  EXPECT_EQ(path.refine({}), 1.0);
  EXPECT_TRUE(path.T_cam_world(0).isApprox(Pose::Identity()));
}

TEST(FitMotionTest, StaticPointsDetermineTheDisparitiesOffset) {
  Drive drive;
  std::vector<stereo::OffsetEvidence> evidence;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d start(8 * place(random), place(random), 25 + 12 * place(random));
    const auto motion =
        fitMotion(drive.see(start, {0, 0, 0}, 0.2, -0.8), drive.path, drive.camera, {}, 30.0);
    ASSERT_TRUE(motion);
    evidence.push_back(motion->offsetEvidence());
  }
  stereo::DisparityOffset offset;
  for (int frame = 0; frame < 3; ++frame) offset.update(evidence);
  EXPECT_LT(offset.value(), -0.5);
}

}  // namespace
}  // namespace headway::detect
