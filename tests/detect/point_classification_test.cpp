// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "point_motion.h"

namespace headway::detect {
namespace {

const Eigen::Vector3d kUpward(0.0, -1.0, 0.0);
constexpr int kSightings = 6;

/// A point whose fits have the given squared errors to a degree of freedom.
PointTrack fitted(const Eigen::Vector3d& velocity, double static_fit, double moving_fit,
                  double sigma = 0.1) {
  PointMotion motion;
  motion.observations = kSightings;
  motion.velocity = motion.steady_velocity = velocity;
  motion.velocity_covariance = motion.steady_covariance =
      sigma * sigma * Eigen::Matrix3d::Identity();
  motion.static_error = static_fit * 3.0 * (kSightings - 1);
  motion.moving_error = motion.accelerated_error = moving_fit * (3.0 * (kSightings - 2) + 1.0);
  PointTrack track;
  track.motion = motion;
  return track;
}

PointClass classOf(const PointTrack& track) { return classifyPoint(track, kUpward, {}); }

TEST(ClassifyPointTest, OnlyMotionExplainsAMovingPoint) {
  EXPECT_EQ(classOf(fitted({1.5, 0.0, 0.0}, 9.0, 1.0)), PointClass::kMoving);
}

TEST(ClassifyPointTest, AStaticPointIsExplainedByStandingStill) {
  EXPECT_EQ(classOf(fitted({0.1, 0.0, 0.0}, 1.0, 1.0)), PointClass::kStatic);
}

TEST(ClassifyPointTest, WhatNeitherExplainsIsAMismatch) {
  EXPECT_EQ(classOf(fitted({1.5, 0.0, 0.0}, 9.0, 8.0)), PointClass::kMismatch);
}

TEST(ClassifyPointTest, WithoutAFitOrWithFewObservationsItIsUnknown) {
  EXPECT_EQ(classOf(PointTrack()), PointClass::kUnknown);
  PointTrack seen_twice = fitted({1.5, 0.0, 0.0}, 30.0, 0.5);
  seen_twice.motion->observations = 2;
  EXPECT_EQ(classOf(seen_twice), PointClass::kUnknown);
}

TEST(ClassifyPointTest, BetweenTheTwoItIsUnknown) {
  EXPECT_EQ(classOf(fitted({1.5, 0.0, 0.0}, 4.0, 3.5)), PointClass::kUnknown);
}

TEST(ClassifyPointTest, AnInsignificantSpeedIsNoMotion) {
  EXPECT_EQ(classOf(fitted({1.5, 0.0, 0.0}, 9.0, 1.0, 1.0)), PointClass::kUnknown);
}

TEST(ClassifyPointTest, SpeedsOutsideTheLimitsAreNoMotion) {
  EXPECT_NE(classOf(fitted({0.5, 0.0, 0.0}, 9.0, 1.0)), PointClass::kMoving) << "too slow";
  EXPECT_NE(classOf(fitted({70.0, 0.0, 0.0}, 9.0, 1.0)), PointClass::kMoving) << "too fast";
}

TEST(ClassifyPointTest, MotionMustBeOverTheGround) {
  EXPECT_NE(classOf(fitted({0.0, 3.0, 0.0}, 9.0, 1.0)), PointClass::kMoving);
  EXPECT_NE(classOf(fitted({1.0, 3.0, 0.0}, 9.0, 1.0)), PointClass::kMoving);
  EXPECT_EQ(classOf(fitted({1.5, 0.5, 0.0}, 9.0, 1.0)), PointClass::kMoving);
}

}  // namespace
}  // namespace headway::detect
