// SPDX-License-Identifier: BSD-3-Clause
#include "kalman_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

namespace headway::objects {
namespace {

MeasuredBox boxAt(double x, double y, double yaw = 0.0) {
  MeasuredBox box;
  box.object_class = ObjectClass::kCar;
  box.position = {x, y, 0.5};
  box.covariance << 0.09, 0.03, 0.03, 0.04;
  box.vertical_variance = 0.01;
  box.yaw = yaw;
  box.size = {4.0, 1.7, 1.5};
  return box;
}

TEST(TransitionTest, OfTwoStepsIsThatOfBothTogether) {
  for (const double dt : {1e-4, 0.05, 0.1, 1.0, 7.0}) {
    const Transition one(dt, 0.8);
    const Transition two(2.0 * dt, 0.8);
    EXPECT_LT((one.F * one.F - two.F).norm(), 1e-9 * two.F.norm());
    const Eigen::Matrix3d chained = one.F * one.Q * one.F.transpose() + one.Q;
    EXPECT_LT((chained - two.Q).norm(), 2e-4 * two.Q.norm()) << dt;
  }
}

TEST(TransitionTest, IsTheIdentityForZeroTime) {
  const Transition still(0.0, 1.0);
  EXPECT_EQ(still.F, Eigen::Matrix3d::Identity());
  EXPECT_EQ(still.Q.norm(), 0.0);
}

TEST(TransitionTest, LetsARateConvergeOverALongGap) {
  const Transition gap(60.0, 1.0);
  EXPECT_NEAR(gap.F(0, 2), 59.0, 1e-6) << "an acceleration of 1 brings 1 m/s, not 60";
  EXPECT_TRUE(gap.Q.allFinite());
  EXPECT_GE(gap.Q.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), -1e-9);
}

TEST(KalmanFilterTest, FollowsAConstantVelocity) {
  KalmanFilter filter(boxAt(0.0, 0.0), FilterParams());
  const Transition step(0.1, 1.0);
  for (int k = 1; k <= 60; ++k) {
    filter.predict(step, false);
    filter.updatePlace(boxAt(1.2 * k, -0.5 * k));
  }
  EXPECT_NEAR(filter.position().x(), 72.0, 0.02);
  EXPECT_NEAR(filter.velocity().x(), 12.0, 0.05);
  EXPECT_NEAR(filter.velocity().y(), -5.0, 0.05);
}

// The textbook filter over the 6-state block, to hold the block arithmetic against.
TEST(KalmanFilterTest, IsTheFullFilterInBlocks) {
  const FilterParams params;
  KalmanFilter filter(boxAt(1.0, 2.0), params);
  const Transition step(0.13, 0.9);
  Eigen::Matrix<double, 6, 6> F = Eigen::Matrix<double, 6, 6>::Zero();
  F.topLeftCorner<3, 3>() = F.bottomRightCorner<3, 3>() = step.F;
  Eigen::Matrix<double, 6, 6> Q = Eigen::Matrix<double, 6, 6>::Zero();
  const double sigma = params.acceleration_sigma_mps2.of(ObjectClass::kCar);
  Q.topLeftCorner<3, 3>() = Q.bottomRightCorner<3, 3>() = sigma * sigma * step.Q;
  Eigen::Matrix<double, 2, 6> H = Eigen::Matrix<double, 2, 6>::Zero();
  H(0, 0) = H(1, 3) = 1.0;

  Eigen::Matrix<double, 6, 1> mean;
  mean << 1.0, 0.0, 0.0, 2.0, 0.0, 0.0;
  const double speed = params.initial_speed_sigma_mps.of(ObjectClass::kCar);
  Eigen::Matrix<double, 6, 6> P = Eigen::Matrix<double, 6, 6>::Zero();
  P.diagonal() << 0.09, speed * speed, sigma * sigma, 0.04, speed * speed, sigma * sigma;
  P(0, 3) = P(3, 0) = 0.03;
  for (int k = 0; k < 10; ++k) {
    const MeasuredBox box = boxAt(1.0 + 0.8 * k, 2.0 + std::sin(k));
    filter.predict(step, false);
    filter.updatePlace(box);
    mean = F * mean;
    P = F * P * F.transpose() + Q;
    const Eigen::Matrix<double, 6, 2> K =
        P * H.transpose() * (H * P * H.transpose() + box.covariance).inverse();
    mean += K * (box.position.head<2>() - H * mean);
    P -= K * H * P;
    EXPECT_LT((filter.position().head<2>() - H * mean).norm(), 1e-9);
    EXPECT_LT((filter.positionCovariance() - H * P * H.transpose()).norm(), 1e-9);
    EXPECT_NEAR(filter.velocity().y(), mean(4), 1e-9);
    EXPECT_NEAR(filter.velocityCovariance()(0, 1), P(1, 4), 1e-9);
  }
}

TEST(KalmanFilterTest, StartsAtAMeasuredVelocity) {
  MeasuredBox box = boxAt(0.0, 0.0);
  box.velocity = GroundVelocity{{12.0, -5.0}, 0.04 * Eigen::Matrix2d::Identity()};
  KalmanFilter filter(box, FilterParams());
  EXPECT_NEAR(filter.velocity().x(), 12.0, 0.05);
  EXPECT_NEAR(filter.velocity().y(), -5.0, 0.05);
  EXPECT_LT(filter.velocityCovariance()(0, 0), 0.04);
}

TEST(KalmanFilterTest, WeighsAMeasuredVelocityByItsCovariance) {
  MeasuredBox box = boxAt(0.0, 0.0);
  box.velocity = GroundVelocity{{10.0, 0.0}, Eigen::Matrix2d::Identity()};
  KalmanFilter filter(box, FilterParams());
  const double before = filter.velocityCovariance()(0, 0);
  filter.updateVelocity({{12.0, 0.0}, before * Eigen::Matrix2d::Identity()});
  EXPECT_NEAR(filter.velocity().x(), 11.0, 0.1) << "as sure as the filter: half way";
  EXPECT_NEAR(filter.velocityCovariance()(0, 0), 0.5 * before, 0.02 * before);
  filter.predict(Transition(0.1, 1.0), false);
  EXPECT_NEAR(filter.position().x(), 1.1, 0.05);
}

TEST(KalmanFilterTest, AMeanOverTheLastSecondIsTheVelocityOfHalfASecondAgo) {
  const auto velocityBy = [](double age_s) {  // setting off at 1 m/s^2
    KalmanFilter filter(boxAt(0.0, 0.0), FilterParams());
    for (int k = 1; k <= 10; ++k) {
      const double t = 0.1 * k;
      filter.predict(Transition(0.1, 1.0), false);
      MeasuredBox box = boxAt(0.5 * t * t, 0.0);
      box.covariance *= 0.01;
      filter.updatePlace(box);
      filter.updateVelocity(
          {{std::max(0.0, t - 0.5), 0.0}, 0.01 * Eigen::Matrix2d::Identity(), age_s});
    }
    return filter.velocity().x();
  };
  EXPECT_GT(velocityBy(0.5), 0.85) << "of 1 m/s";
  EXPECT_LT(velocityBy(0.0), velocityBy(0.5) - 0.1) << "taken for new, it holds the filter back";
}

TEST(KalmanFilterTest, TurnsOnThroughHalfATurn) {
  KalmanFilter filter(boxAt(0, 0, 3.0), FilterParams());
  const Transition step(0.1, 1.0);
  double yaw = 3.0;
  for (int k = 0; k < 40; ++k) {
    yaw = wrapAngle(yaw + 0.05);
    filter.predict(step, false);
    filter.updateYaw(yaw, 0.15);
  }
  EXPECT_NEAR(wrapAngle(filter.yaw() - yaw), 0.0, 0.05);
  EXPECT_NEAR(filter.yawRate(), 0.5, 0.1);
}

MeasuredBox ofSize(const Eigen::Vector3d& size, double sigma_m = 0.2) {
  MeasuredBox box = boxAt(0, 0);
  box.size = size;
  box.size_sigma_m = sigma_m;
  return box;
}

TEST(KalmanFilterTest, DoesNotChangeAConvergedSize) {
  KalmanFilter filter(boxAt(0, 0), FilterParams());
  for (int k = 0; k < 40; ++k)
    filter.updateSize(ofSize({4.0 + (k % 2 == 0 ? 0.2 : -0.2), 1.7, 1.5}));
  const Eigen::Vector3d converged = filter.size();
  EXPECT_NEAR(converged.x(), 4.0, 0.05);
  for (int k = 0; k < 40; ++k) filter.updateSize(ofSize({2.0, 1.0, 1.0}));  // half hidden
  EXPECT_EQ(filter.size(), converged);
}

TEST(KalmanFilterTest, BetterViewsChangeAConvergedSize) {
  KalmanFilter filter(ofSize({3.5, 1.5, 1.3}, 0.6), FilterParams());
  for (int k = 0; k < 100; ++k) filter.updateSize(ofSize({3.5, 1.5, 1.3}, 0.6));  // far away
  for (int k = 0; k < 40; ++k) filter.updateSize(ofSize({4.2, 1.8, 1.6}, 0.2));   // near
  EXPECT_NEAR(filter.size().x(), 4.2, 0.1);
  EXPECT_NEAR(filter.size().y(), 1.8, 0.05);
  EXPECT_NEAR(filter.size().z(), 1.6, 0.05);
}

}  // namespace
}  // namespace headway::objects
