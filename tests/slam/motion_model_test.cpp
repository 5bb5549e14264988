// SPDX-License-Identifier: BSD-3-Clause
#include "motion_model.h"

#include <gtest/gtest.h>

namespace headway::slam {
namespace {

StereoFrame frameAt(Time time) {
  StereoFrame frame;
  frame.time = time;
  return frame;
}

Pose step() {
  Pose pose = Pose::Identity();
  pose.translation() << 0.1, 0.0, 0.5;
  pose.linear() = expSo3({0.0, 0.02, 0.0});
  return pose;
}

/// A model that saw two poses 0.1 s apart.
MotionModel moving() {
  MotionModel model(robotFromOptical(), SlamParams{});
  model.reset(1.0, Pose::Identity());
  model.update(1.1, step());
  return model;
}

TEST(MotionModelTest, BeginsLevelWithYawZero) {
  const Eigen::Vector3d up = Eigen::Vector3d(0.1, -0.2, 1.0).normalized();
  MotionModel model(robotFromOptical(), SlamParams{});
  model.initialise(1.0, up);
  const Pose T_map_robot = model.last() * robotFromOptical().inverse();
  EXPECT_LT((T_map_robot.linear() * up - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
  EXPECT_NEAR(yawOf(T_map_robot), 0.0, 1e-9);
  model.initialise(1.0, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(model.last().matrix(), robotFromOptical().matrix());
}

TEST(MotionModelTest, DisabledGyroscopeDoesNotTurnThePrediction) {
  StereoFrame frame = frameAt(1.2);
  frame.motion_prior.R_previous_current = expSo3({0.0, 0.0, 0.3});
  MotionModel model = moving();
  model.disableImu();
  EXPECT_TRUE(model.predict(frame).isApprox(step() * step(), 1e-9));
}

TEST(MotionModelTest, GoesOnAtConstantVelocity) {
  const Pose expected = step() * step();
  EXPECT_TRUE(moving().predict(frameAt(1.2)).isApprox(expected, 1e-9));
}

TEST(MotionModelTest, StaysAtTheLastPoseAfterALongGap) {
  EXPECT_TRUE(moving().predict(frameAt(100.0)).isApprox(step(), 1e-12));
  EXPECT_TRUE(moving().predict(frameAt(0.5)).isApprox(step(), 1e-12));
}

TEST(MotionModelTest, OdometryReplacesTheConstantVelocity) {
  StereoFrame frame = frameAt(1.2);
  Pose forward = Pose::Identity();
  forward.translation() << 2.0, 0.0, 0.0;  // robot axes: along the optical z axis
  frame.motion_prior.T_previous_current = forward;
  const Eigen::Vector3d place = moving().predict(frame).translation();
  EXPECT_LT((place - step() * Eigen::Vector3d(0.0, 0.0, 2.0)).norm(), 1e-9);
}

TEST(MotionModelTest, TurnsAsTheGyroscopeSays) {
  StereoFrame frame = frameAt(1.2);
  frame.motion_prior.R_previous_current = expSo3({0.0, 0.0, 0.3});  // robot's z is optical -y
  const Eigen::Matrix3d expected = step().linear() * expSo3({0.0, -0.3, 0.0});
  EXPECT_TRUE(moving().predict(frame).linear().isApprox(expected, 1e-9));
}

TEST(MotionModelTest, ComesToRestWhileLost) {
  MotionModel model = moving();
  for (int i = 0; i < 120; ++i) model.coast(1.2 + 0.1 * i, model.predict(frameAt(1.2 + 0.1 * i)));
  const Pose last = model.last();
  EXPECT_LT((model.predict(frameAt(13.2)).translation() - last.translation()).norm(), 1e-4);
}

}  // namespace
}  // namespace headway::slam
