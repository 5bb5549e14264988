// SPDX-License-Identifier: BSD-3-Clause
#include "motion_prior.h"

#include <gmock/gmock.h>

#include <cmath>

namespace headway::io {
namespace {

Pose along(double x, double yaw = 0.0) {
  Pose pose = Pose::Identity();
  pose.translation().x() = x;
  pose.linear() = expSo3({0, 0, yaw});
  return pose;
}

TEST(MotionPriorTest, IsEmptyWithoutSamples) {
  const MotionPriorBuilder builder;
  const MotionPrior prior = builder.between(1.0, 1.1);
  EXPECT_FALSE(prior.T_previous_current);
  EXPECT_FALSE(prior.R_previous_current);
  EXPECT_FALSE(prior.velocity_increment);
  EXPECT_FALSE(prior.specific_force);
}

TEST(MotionPriorTest, OdometryIsRelativeToThePreviousFrame) {
  MotionPriorBuilder builder;
  builder.addOdometry(1.0, along(5.0, M_PI / 2));
  Pose moved = along(5.0, M_PI / 2);
  moved.translation().y() = 1.0;  // one metre ahead of a robot that faces y
  builder.addOdometry(1.1, moved);
  const auto prior = builder.between(1.0, 1.1).T_previous_current;
  ASSERT_TRUE(prior);
  EXPECT_TRUE(prior->isApprox(along(1.0), 1e-12));
}

TEST(MotionPriorTest, DoesNotExtrapolateOrBridgeGaps) {
  MotionPriorBuilder builder;
  builder.addOdometry(1.0, along(0));
  builder.addOdometry(1.1, along(1));
  EXPECT_FALSE(builder.between(1.0, 1.2).T_previous_current);
  EXPECT_FALSE(builder.between(0.9, 1.1).T_previous_current);
  builder.addOdometry(9.0, along(2));
  EXPECT_FALSE(builder.between(1.1, 5.0).T_previous_current);
}

TEST(MotionPriorTest, IgnoresSamplesWithDecreasingTime) {
  MotionPriorBuilder builder;
  builder.addOdometry(1.0, along(0));
  builder.addOdometry(0.5, along(100));
  builder.addOdometry(1.1, along(1));
  EXPECT_NEAR(1.0, builder.between(1.0, 1.1).T_previous_current->translation().x(), 1e-12);
}

TEST(MotionPriorTest, IntegratesAVaryingRotation) {
  MotionPriorBuilder builder;
  for (int i = 0; i <= 30; ++i) {  // the rate grows steadily: the trapezoid rule is exact
    const double time = 0.01 * i;
    builder.addInertial({time, Eigen::Vector3d(0, 0, time), std::nullopt});
  }
  const auto turn = builder.between(0.105, 0.205).R_previous_current;
  ASSERT_TRUE(turn);
  const double expected = 0.5 * (0.205 * 0.205 - 0.105 * 0.105);
  EXPECT_NEAR(expected, logSo3(*turn).z(), 1e-12);
}

TEST(MotionPriorTest, AGapInTheGyroscopeGivesNoRotation) {
  MotionPriorBuilder builder;
  for (const double time : {0.0, 0.01, 0.3, 0.31}) {
    builder.addInertial({time, Eigen::Vector3d(0, 0, 1), std::nullopt});
  }
  EXPECT_FALSE(builder.between(0.005, 0.305).R_previous_current);
}

TEST(MotionPriorTest, SpecificForceIsTheMeanAroundTheFrame) {
  MotionPriorBuilder builder;
  const Eigen::Vector3d force(6.0, 0.0, 8.0);
  for (int i = 0; i < 10; ++i) {
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    builder.addInertial({0.01 * i, std::nullopt, Eigen::Vector3d((1.0 + 0.1 * sign) * force)});
  }
  const auto mean = builder.between(std::nullopt, 0.1).specific_force;
  ASSERT_TRUE(mean);
  EXPECT_TRUE(mean->isApprox(force, 1e-12));
  EXPECT_FALSE(builder.between(std::nullopt, 1.0).specific_force);
}

TEST(MotionPriorTest, VelocityIncrementFollowsTheTurn) {
  // A force along the robot's x axis while it turns at a constant rate: sin and cos integrate.
  MotionPriorBuilder builder;
  const double rate = 1.5;
  for (int i = 0; i <= 200; ++i) {
    builder.addInertial({0.001 * i, Eigen::Vector3d(0, 0, rate), Eigen::Vector3d(2, 0, 9.81)});
  }
  const auto increment = builder.between(0.05, 0.15).velocity_increment;
  ASSERT_TRUE(increment);
  const double angle = rate * 0.1;
  const Eigen::Vector3d expected(2.0 * std::sin(angle) / rate, 2.0 * (1.0 - std::cos(angle)) / rate,
                                 0.981);
  EXPECT_LT((*increment - expected).norm(), 1e-6);
}

TEST(MotionPriorTest, VelocityIncrementNeedsBothSensorsThroughout) {
  MotionPriorBuilder without_gyroscope, gap;
  for (const double time : {0.0, 0.01, 0.3, 0.31}) {
    gap.addInertial({time, Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 0, 9.81)});
  }
  for (int i = 0; i <= 30; ++i) {
    without_gyroscope.addInertial({0.01 * i, std::nullopt, Eigen::Vector3d(0, 0, 9.81)});
  }
  EXPECT_FALSE(gap.between(0.005, 0.305).velocity_increment);
  EXPECT_FALSE(without_gyroscope.between(0.1, 0.2).velocity_increment);
}

TEST(MotionPriorTest, DiscardingKeepsTheSamplesOfLaterFrames) {
  MotionPriorBuilder builder, discarding;
  for (int i = 0; i < 500; ++i) {
    const double time = 0.01 * i;
    const InertialSample sample{time, Eigen::Vector3d(0, std::sin(time), 1),
                                Eigen::Vector3d(0, 0, 9.8)};
    for (auto* one : {&builder, &discarding}) {
      one->addOdometry(time, along(time));
      one->addInertial(sample);
    }
    discarding.discardBefore(time);
  }
  const auto a = builder.between(4.8, 4.9);
  const auto b = discarding.between(4.8, 4.9);
  ASSERT_TRUE(b.T_previous_current && b.R_previous_current && b.specific_force &&
              b.velocity_increment);
  EXPECT_EQ(a.T_previous_current->matrix(), b.T_previous_current->matrix());
  EXPECT_EQ(*a.R_previous_current, *b.R_previous_current);
  EXPECT_EQ(*a.velocity_increment, *b.velocity_increment);
  EXPECT_FALSE(discarding.between(0.5, 0.6).T_previous_current);
}

TEST(MotionPriorTest, MotionJoinedOverASkippedFrameIsThatBetweenTheOthers) {
  MotionPriorBuilder builder;
  for (int i = 0; i <= 300; ++i) {
    const double time = 0.001 * i;
    builder.addOdometry(time, along(2.0 * time, 0.5 * time));
    builder.addInertial({time, Eigen::Vector3d(0, 0, 1.5), Eigen::Vector3d(2, 0, 9.81)});
  }
  StereoFrame skipped;
  skipped.index = 7;
  skipped.motion_prior = builder.between(0.05, 0.15);
  const MotionPrior all = joined(skipped, builder.between(0.15, 0.25));
  const MotionPrior expected = builder.between(0.05, 0.25);
  EXPECT_EQ(6U, all.previous_frame.value());
  EXPECT_TRUE(all.T_previous_current->isApprox(*expected.T_previous_current, 1e-9));
  EXPECT_TRUE(all.R_previous_current->isApprox(*expected.R_previous_current, 1e-9));
  EXPECT_LT((*all.velocity_increment - *expected.velocity_increment).norm(), 1e-6);
  EXPECT_EQ(all.specific_force.has_value(), expected.specific_force.has_value());

  MotionPrior elsewhere = builder.between(0.15, 0.25);
  elsewhere.previous_frame = 5;
  EXPECT_EQ(5U, joined(skipped, elsewhere).previous_frame.value()) << "it is no continuation";
  skipped.motion_prior.T_previous_current.reset();
  EXPECT_FALSE(joined(skipped, builder.between(0.15, 0.25)).T_previous_current);
}

}  // namespace
}  // namespace headway::io
