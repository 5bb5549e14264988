// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "wheel_odometry.h"

namespace headway::slam {
namespace {

constexpr double kPeriod = 0.1;  // [s]

Pose step(double metres, double turn = 0.0) {
  Pose pose = Pose::Identity();
  pose.translation().x() = metres;
  pose.linear() = expSo3({0.0, 0.0, turn});
  return pose;
}

MotionPrior wheels(const Pose& motion) {
  MotionPrior prior;
  prior.T_previous_current = motion;
  return prior;
}

class OdometryCheckTest : public testing::Test {
 protected:
  bool agrees(const Pose& by_camera, const MotionPrior& prior, double sigma_m = 0.002) {
    time_ += kPeriod;
    return check_.add({time_, by_camera, sigma_m, 0.0005}, prior);
  }

  OdometryCheck check_;

 private:
  double time_ = 0.0;
};

TEST_F(OdometryCheckTest, WheelsMayBeWrongByTheirUsualErrors) {
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(agrees(step(0.1, 0.05), wheels(step(0.104, 0.053)))) << "scale, track width " << i;
  }
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(agrees(step(2.0), wheels(step(2.08)))) << "a car " << i;
  for (int i = 0; i < 30; ++i) {
    Pose ramp = step(0.1);
    ramp.translation().z() = 0.015;  // 15 % of slope, which wheels do not measure
    ASSERT_TRUE(agrees(ramp, wheels(step(0.1)))) << i;
  }
}

TEST_F(OdometryCheckTest, ACameraThatSeemsToStandIsNoticedWithinThreeFrames) {
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(agrees(step(0.08), wheels(step(0.08))));
  int frames = 1;
  while (agrees(step(0.0), wheels(step(0.08)))) ++frames;
  EXPECT_LE(frames, 2);
}

TEST_F(OdometryCheckTest, ATurnThatTheWheelsDidNotMakeIsNoticed) {
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(agrees(step(0.02), wheels(step(0.02))));
  int frames = 1;
  while (agrees(step(0.02, 0.02), wheels(step(0.02)))) ++frames;
  EXPECT_LE(frames, 3);
}

TEST_F(OdometryCheckTest, AnUncertainCameraContradictsLater) {
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(agrees(step(0.0), wheels(step(0.02)), 0.1));
}

TEST_F(OdometryCheckTest, AContradictionEndsASecondAfterItsCause) {
  EXPECT_TRUE(agrees(step(0.1), wheels(step(0.1))));
  EXPECT_FALSE(agrees(step(0.4), wheels(step(0.1)))) << "a jump";
  int frames = 0;
  while (!agrees(step(0.1), wheels(step(0.1)))) ++frames;
  EXPECT_GE(frames, 4);
  EXPECT_LE(frames, 10);
}

TEST_F(OdometryCheckTest, WhatWasBeforeAGapDoesNotCount) {
  EXPECT_TRUE(agrees(step(0.1), wheels(step(0.1))));
  EXPECT_FALSE(agrees(step(0.4), wheels(step(0.1))));
  EXPECT_TRUE(agrees(step(0.4), {})) << "no odometry";
  EXPECT_TRUE(agrees(step(0.1), wheels(step(0.1))));
  EXPECT_FALSE(agrees(step(0.4), wheels(step(0.1))));
  check_.restart();
  EXPECT_TRUE(agrees(step(0.1), wheels(step(0.1))));
}

}  // namespace
}  // namespace headway::slam
