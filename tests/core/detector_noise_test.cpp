// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/detector_noise.h>

#include <Eigen/Eigenvalues>
#include <cmath>

namespace headway {
namespace {

const Box3d kTruth{{3.0, 0.5, 20.0}, 4.0, 1.8, 1.5, 0.3};

DetectorNoise everyNoise() {
  DetectorNoise noise;
  noise.along_sigma_m = 0.6;
  noise.across_sigma_m = 0.2;
  noise.vertical_variance_ratio = 0.25;
  noise.size_sigma_ratio = 0.05;
  noise.yaw_sigma_rad = 0.1;
  return noise;
}

TEST(DetectorNoiseTest, WithoutNoiseMeasuresTheTruth) {
  Random random(1);
  const Box3d box = measuredBox(kTruth, DetectorNoise(), random);
  EXPECT_EQ(box.centre, kTruth.centre);
  EXPECT_EQ(box.length, kTruth.length);
  EXPECT_EQ(box.width, kTruth.width);
  EXPECT_EQ(box.height, kTruth.height);
  EXPECT_EQ(box.yaw, kTruth.yaw);
}

TEST(DetectorNoiseTest, CentresMatchTheirCovariance) {
  Random random(2);
  const int count = 20000;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d error = measuredBox(kTruth, everyNoise(), random).centre - kTruth.centre;
    sum += error;
    scatter += error * error.transpose() / count;
  }
  EXPECT_LT((sum / count).norm(), 0.02);
  const Eigen::Matrix3d stated = centreCovariance(kTruth.centre, everyNoise());
  EXPECT_LT((scatter - stated).cwiseAbs().maxCoeff(), 0.015);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(stated);
  EXPECT_GT(axes.eigenvalues()[0], 0.0);
  EXPECT_GT(std::abs(axes.eigenvectors().col(2).dot(kTruth.centre.normalized())), 0.99)
      << "the longest axis is the viewing ray";
}

TEST(DetectorNoiseTest, SizesStayWithinTheirBounds) {
  Random random(3);
  DetectorNoise noise;
  noise.size_sigma_ratio = 2.0;
  for (int i = 0; i < 1000; ++i) {
    const Box3d box = measuredBox(kTruth, noise, random);
    EXPECT_GE(box.length, 0.6 * kTruth.length);
    EXPECT_LE(box.length, 1.5 * kTruth.length);
  }
}

TEST(DetectorNoiseTest, FlipsHeadingsWithTheGivenProbability) {
  Random random(4);
  DetectorNoise noise;
  noise.flip_probability = 0.25;
  int flipped = 0;
  for (int i = 0; i < 8000; ++i) {
    const double turn = std::abs(wrapAngle(measuredBox(kTruth, noise, random).yaw - kTruth.yaw));
    EXPECT_TRUE(turn < 1e-12 || std::abs(turn - M_PI) < 1e-12);
    flipped += turn > 1.0 ? 1 : 0;
  }
  EXPECT_NEAR(flipped, 2000, 150);
}

TEST(DetectorNoiseTest, OneSigmaDoesNotChangeTheOtherErrors) {
  Random one(5), other(5);
  DetectorNoise noise = everyNoise();
  const Box3d first = measuredBox(kTruth, noise, one);
  noise.along_sigma_m = 0.0;
  const Box3d second = measuredBox(kTruth, noise, other);
  EXPECT_NE(first.centre, second.centre);
  EXPECT_EQ(first.length, second.length);
  EXPECT_EQ(first.yaw, second.yaw);
  EXPECT_EQ(one.bits(), other.bits());
}

TEST(DetectorNoiseTest, ScalesTheErrorsOfTheCentreAlone) {
  const DetectorNoise twice = withCentreScaled(everyNoise(), 2.0);
  EXPECT_EQ(twice.along_sigma_m, 1.2);
  EXPECT_EQ(twice.across_sigma_m, 0.4);
  EXPECT_EQ(twice.vertical_variance_ratio, 0.25);
  EXPECT_EQ(twice.size_sigma_ratio, everyNoise().size_sigma_ratio);
  EXPECT_EQ(twice.yaw_sigma_rad, everyNoise().yaw_sigma_rad);
}

}  // namespace
}  // namespace headway
