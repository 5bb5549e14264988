// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <random>

#include "measurement_model.h"

namespace headway::objects {
namespace {

// A box with the noise that its detector states, 0.2 m.
MeasuredBox boxAt(const Eigen::Vector3d& position) {
  MeasuredBox box;
  box.covariance = 0.04 * Eigen::Matrix2d::Identity();
  box.position = position;
  return box;
}

// The scale learnt from detections `factor` times as noisy as they say.
double learntFrom(double factor, double adaption) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise;
  NoiseScale scale(adaption);
  ExpectedPlace expected;
  expected.covariance = 1e-6 * Eigen::Matrix2d::Identity();
  for (int k = 0; k < 4000; ++k) {
    const double x = noise(random), y = noise(random);
    scale.learn(expected, scale.scaled(boxAt(0.2 * factor * Eigen::Vector3d(x, y, 0.0))));
  }
  return scale.value();
}

TEST(NoiseScaleTest, ConvergesToTheDetectorsNoise) {
  EXPECT_NEAR(learntFrom(1.0, 0.005), 1.0, 0.15);
  EXPECT_NEAR(learntFrom(2.5, 0.005), 2.5, 0.4);
  EXPECT_NEAR(learntFrom(0.1, 0.005), 0.1, 0.015) << "boxes far better than configured";
}

TEST(NoiseScaleTest, StaysAsConfiguredWithoutAdaption) { EXPECT_EQ(learntFrom(3.0, 0.0), 1.0); }

TEST(NoiseScaleTest, IsBoundedBothWays) {
  EXPECT_NEAR(learntFrom(0.0, 0.02), 0.05, 1e-12);
  EXPECT_LE(learntFrom(100.0, 0.02), 4.0);
}

TEST(NoiseScaleTest, ScalesStandardDeviations) {
  NoiseScale scale(0.5);
  MeasuredBox far;
  far.position = {100.0, 0.0, 0.0};
  scale.learn(ExpectedPlace(), far);
  const MeasuredBox box = scale.scaled(MeasuredBox());
  EXPECT_GT(scale.value(), 1.0);
  EXPECT_DOUBLE_EQ(box.covariance(0, 0), scale.value() * scale.value());
  EXPECT_DOUBLE_EQ(box.vertical_variance, scale.value() * scale.value());
}

TEST(NoiseScaleTest, WhatADetectorStatesAndDoesNotScatterByIsShared) {
  MeasuredBox stated = boxAt(Eigen::Vector3d::Zero());
  stated.shared_covariance = stated.covariance;
  NoiseScale precise(0.5), noisy(0.5);
  for (int k = 0; k < 10; ++k) precise.learn(ExpectedPlace(), stated);
  MeasuredBox far = stated;
  far.position.x() = 100.0;
  noisy.learn(ExpectedPlace(), far);
  const MeasuredBox box = precise.scaled(stated);
  EXPECT_LT(box.covariance(0, 0), 0.5 * stated.covariance(0, 0));
  EXPECT_NEAR((box.covariance + box.shared_covariance - stated.covariance).norm(), 0.0, 1e-12);
  EXPECT_EQ(noisy.scaled(stated).shared_covariance(0, 0), 0.0) << "it scatters by more";
}

}  // namespace
}  // namespace headway::objects
