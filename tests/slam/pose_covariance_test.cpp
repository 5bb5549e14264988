// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/stereo/pose_refiner.h>

#include "motion_model.h"

namespace headway::slam {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

Pose poseOf(const Eigen::Vector3d& translation, const Eigen::Vector3d& rotation) {
  Pose pose = Pose::Identity();
  pose.translation() = translation;
  pose.linear() = expSo3(rotation);
  return pose;
}

/// By how much a pose differs from another, as seen from that.
Vector6 difference(const Pose& from, const Pose& to) {
  const Pose step = from.inverse(Eigen::Isometry) * to;
  Vector6 xi;
  xi << step.translation(), logSo3(step.linear());
  return xi;
}

TEST(ComposedCovarianceTest, IsThatOfNumericDifferences) {
  const Pose T_a_b = poseOf({1.0, -2.0, 0.5}, {0.3, -0.1, 0.9});
  const Pose T_b_c = poseOf({4.0, 0.7, -3.0}, {-0.4, 0.8, 0.2});
  PoseCovariance of_ab = PoseCovariance::Zero(), of_bc = PoseCovariance::Zero();
  of_ab.diagonal() << 0.1, 0.2, 0.3, 0.01, 0.02, 0.03;
  of_bc.diagonal() << 0.6, 0.5, 0.4, 0.06, 0.05, 0.04;
  constexpr double kStep = 1e-6;
  PoseCovariance jacobian;  // of T_a_c by an error of T_a_b
  for (int axis = 0; axis < 6; ++axis) {
    const Vector6 xi = kStep * Vector6::Unit(axis);
    jacobian.col(axis) = difference(T_a_b * T_b_c, stereo::retract(T_a_b, xi) * T_b_c) / kStep;
  }
  const PoseCovariance expected = jacobian * of_ab * jacobian.transpose() + of_bc;
  EXPECT_LT((composedCovariance(of_ab, T_b_c, of_bc) - expected).norm(), 1e-5 * expected.norm());
}

TEST(ComposedCovarianceTest, ATurnMovesWhatIsFarAway) {
  PoseCovariance turning = PoseCovariance::Zero();
  turning(5, 5) = 0.01;  // about z
  const auto far = composedCovariance(turning, poseOf({10.0, 0.0, 0.0}, {0.0, 0.0, 0.0}),
                                      PoseCovariance::Zero());
  EXPECT_NEAR(far(1, 1), 1.0, 1e-12) << "0.1 rad at 10 m";
  EXPECT_NEAR(far(0, 0), 0.0, 1e-12);
}

/// What a calibration that is off makes of a turn and the way after it.
TEST(CalibrationCovarianceTest, IsThatOfATurnAndAWayThatAreScaled) {
  const auto moved = [](double turn_error, double way_error) {
    const Pose turned = poseOf(Eigen::Vector3d::Zero(), {0.0, 0.0, (1.0 + turn_error) * 0.8});
    return Pose(turned * poseOf({(1.0 + way_error) * 5.0, 0.0, 0.0}, {0.0, 0.0, 0.0}));
  };
  constexpr double kFocal = 0.003, kBaseline = 0.003, kOffset = 0.01;
  const Pose right = moved(0.0, 0.0);
  PoseCovariance expected = PoseCovariance::Zero();
  for (const Pose& wrong :
       {moved(kFocal, 0.0), moved(0.0, kFocal), moved(0.0, kBaseline), moved(0.0, kOffset)}) {
    expected += difference(right, wrong) * difference(right, wrong).transpose();
  }
  const PoseCovariance found = calibrationCovariance(right, kOffset);
  EXPECT_LT((found - expected).norm(), 0.01 * expected.norm());
}

TEST(CalibrationCovarianceTest, IsNothingWhereTheMapBegins) {
  EXPECT_EQ(calibrationCovariance(Pose::Identity(), 0.01).norm(), 0.0);
}

}  // namespace
}  // namespace headway::slam
