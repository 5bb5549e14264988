// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_motions.h"

#include <gtest/gtest.h>

#include <random>

namespace headway::slam {
namespace {

const StereoCamera kCamera{1240, 376, 700.0, 700.0, 620.0, 188.0, 0.5};

Pose shifted(double x, double y, double z) {
  Pose pose = Pose::Identity();
  pose.translation() << x, y, z;
  return pose;
}

/// Landmarks over columns [left, right) of the image, between two depths, seen from a pose.
void addGroup(std::vector<stereo::PoseConstraint>& constraints, int count, double left,
              double right, double near, double far, const Pose& T_map_cam) {
  std::mt19937 random(static_cast<unsigned>(constraints.size()));
  const auto draw = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int i = 0; i < count; ++i) {
    const double depth = 1.0 / draw(1.0 / far, 1.0 / near);
    stereo::PoseConstraint constraint;
    constraint.point_map =
        depth * ray({draw(left, right), draw(0.0, kCamera.height - 1.0)}, kCamera);
    const auto seen = project(T_map_cam.inverse(Eigen::Isometry) * constraint.point_map, kCamera);
    constraint.measurement.uv = seen->head<2>() + Eigen::Vector2d(draw(-0.5, 0.5), draw(-0.5, 0.5));
    constraints.push_back(constraint);
  }
}

double distance(const Pose& a, const Pose& b) { return (a.translation() - b.translation()).norm(); }

TEST(RigidMotionsTest, StaticSceneIsOneMotion) {
  std::vector<stereo::PoseConstraint> constraints;
  const Pose moved = shifted(0.0, 0.0, 0.8);
  addGroup(constraints, 120, 0.0, 1240.0, 6.0, 60.0, moved);
  const auto motions = rigidMotions(constraints, kCamera, {Pose::Identity()}, 10);
  ASSERT_FALSE(motions.empty());
  EXPECT_LT(distance(motions.front().T_map_cam, moved), 0.05);
  EXPECT_GT(motions.front().members, 115);
}

TEST(RigidMotionsTest, StaticSceneExtendsFartherThanMovingObjectWithMoreLandmarks) {
  std::vector<stereo::PoseConstraint> constraints;
  const Pose moved = shifted(0.0, 0.0, 0.8);
  const Pose as_if = shifted(0.5, 0.0, 0.2);  // the camera's motion if the mover stood still
  addGroup(constraints, 60, 0.0, 1240.0, 6.0, 60.0, moved);
  addGroup(constraints, 90, 300.0, 900.0, 7.0, 8.0, as_if);
  const auto motions = rigidMotions(constraints, kCamera, {Pose::Identity()}, 10);
  ASSERT_GE(motions.size(), 2u);
  EXPECT_LT(distance(motions[0].T_map_cam, as_if), 0.2);
  const std::vector<bool> none(constraints.size(), false);
  const RigidMotion* still = cameraMotion(motions, constraints, none, kCamera);
  ASSERT_NE(still, nullptr);
  EXPECT_LT(distance(still->T_map_cam, moved), 0.05);
  EXPECT_LT(still->members, motions[0].members);
}

TEST(RigidMotionsTest, WhatAgreesOnNothingIsNoMotion) {
  std::vector<stereo::PoseConstraint> constraints;
  for (int i = 0; i < 60; ++i) {
    addGroup(constraints, 1, 0.0, 1240.0, 6.0, 60.0,
             shifted(0.3 * (i % 7) - 1.0, 0.2 * (i % 5) - 0.5, 0.25 * (i % 11)));
  }
  for (const auto& motion : rigidMotions(constraints, kCamera, {Pose::Identity()}, 20)) {
    EXPECT_LT(motion.members, 40);
  }
  EXPECT_TRUE(rigidMotions({}, kCamera, {Pose::Identity()}, 10).empty());
}

TEST(CameraMotionTest, IsThatOfVerifiedStaticLandmarksWhereBothExtendAlike) {
  std::vector<stereo::PoseConstraint> constraints;
  const Pose moved = shifted(0.0, 0.0, 0.8), as_if = shifted(0.5, 0.0, 0.2);
  addGroup(constraints, 60, 0.0, 600.0, 6.0, 20.0, moved);
  addGroup(constraints, 60, 640.0, 1240.0, 6.0, 20.0, as_if);
  const auto motions = rigidMotions(constraints, kCamera, {moved, as_if}, 10);
  for (const bool first : {true, false}) {
    std::vector<bool> proved(constraints.size());
    for (std::size_t i = 0; i < proved.size(); ++i) proved[i] = (i < 60) == first;
    const RigidMotion* still = cameraMotion(motions, constraints, proved, kCamera);
    ASSERT_NE(still, nullptr);
    EXPECT_LT(distance(still->T_map_cam, first ? moved : as_if), 0.05);
  }
  EXPECT_EQ(cameraMotion({}, constraints, {}, kCamera), nullptr);
}

TEST(ExtentBeyondTest, CountsLayersOfDepthAboveDensityAndOnlyWhatTheOtherDoesNotExplain) {
  RigidMotion all, none;
  all.agrees.assign(100, true);
  none.agrees.assign(100, false);
  std::vector<stereo::PoseConstraint> flat, deep;
  addGroup(flat, 100, 0.0, 1240.0, 9.0, 10.0, Pose::Identity());
  addGroup(deep, 100, 0.0, 1240.0, 5.0, 80.0, Pose::Identity());
  EXPECT_GT(extentBeyond(all, none, deep, kCamera), 1.5 * extentBeyond(all, none, flat, kCamera));
  EXPECT_EQ(extentBeyond(all, all, deep, kCamera), 0.0);
}

TEST(PoseOfOneMotionTest, IsNotBetweenTheSceneAndWhatStartsToMoveBeforeIt) {
  constexpr stereo::PoseRefinerOptions kWide{4.0, 3, 6};
  std::vector<stereo::PoseConstraint> constraints;
  const Pose still = Pose::Identity(), as_if = shifted(-0.02, 0.0, 0.005);
  addGroup(constraints, 110, 0.0, 1240.0, 2.5, 12.0, still);
  addGroup(constraints, 70, 200.0, 1000.0, 1.6, 1.9, as_if);
  for (auto& constraint : constraints) constraint.measurement.sigma_px = 0.5;
  const auto between = stereo::refinePose(still, constraints, kCamera, kWide);
  ASSERT_TRUE(between);
  EXPECT_GT(distance(between->T_map_cam, still), 0.01);
  EXPECT_LT(distance(poseOfOneMotion(between->T_map_cam, constraints, kCamera), still), 0.004);
}

TEST(PoseOfOneMotionTest, KeepsAPoseThatFits) {
  std::vector<stereo::PoseConstraint> constraints;
  addGroup(constraints, 110, 0.0, 1240.0, 5.0, 8.0, Pose::Identity());
  const Pose near = shifted(0.001, 0.0, 0.0);
  EXPECT_EQ(poseOfOneMotion(near, constraints, kCamera).matrix(), near.matrix());
}

}  // namespace
}  // namespace headway::slam
