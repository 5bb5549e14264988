// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <random>

#include "recent_motion.h"

namespace headway::objects {
namespace {

constexpr double kSigma = 0.2;  // of a place [m]

PlaceMeasurement placeAt(Time time, double x, double y) {
  return {time, {x, y, 0.0}, Eigen::Matrix2d::Identity() / (kSigma * kSigma), 1.0, {}};
}

TEST(MeasuredMotionTest, ExactPlacesGiveTheirVelocity) {
  std::vector<PlaceMeasurement> places;
  for (int k = 0; k < 8; ++k) places.push_back(placeAt(0.1 * k, 3.0 + 0.12 * k, -0.05 * k));
  const auto motion = measuredMotion(places, 1.0);
  ASSERT_TRUE(motion);
  EXPECT_NEAR(1.2, motion->velocity.x(), 1e-9);
  EXPECT_NEAR(-0.5, motion->velocity.y(), 1e-9);
}

TEST(MeasuredMotionTest, CovarianceIsThatOfTheVelocitiesFound) {
  // Without the worst position the residuals of the others are slightly too small.
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, kSigma);
  double squares = 0.0;
  double claimed = 0.0;
  constexpr int kTrials = 400;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<PlaceMeasurement> places;
    for (int k = 0; k < 8; ++k) places.push_back(placeAt(0.1 * k, noise(random), noise(random)));
    const auto motion = measuredMotion(places, 1.0);
    squares += motion->velocity.squaredNorm();
    claimed += motion->covariance.trace();
  }
  EXPECT_NEAR(1.0, squares / claimed, 0.25);
}

TEST(MeasuredMotionTest, OnePlaceThatIsFarOffMakesNoMotion) {
  std::vector<PlaceMeasurement> places;
  for (int k = 0; k < 6; ++k) places.push_back(placeAt(0.1 * k, 0.0, 0.0));
  places.front().measured.x() = 2.0;
  const auto motion = measuredMotion(places, 1.0);
  ASSERT_TRUE(motion);
  EXPECT_NEAR(0.0, motion->velocity.norm(), 1e-9);
}

TEST(MeasuredMotionTest, UsesTheWindowOnly) {
  std::vector<PlaceMeasurement> places;
  for (int k = 0; k < 10; ++k) places.push_back(placeAt(0.1 * k, 5.0 * k, 0.0));
  for (int k = 10; k < 20; ++k) places.push_back(placeAt(0.1 * k, 50.0, 0.0));
  EXPECT_NEAR(0.0, measuredMotion(places, 0.95)->velocity.norm(), 1e-9);
}

TEST(MeasuredMotionTest, TwoPlacesAreTooFew) {
  EXPECT_FALSE(measuredMotion({placeAt(0.0, 0.0, 0.0), placeAt(0.1, 1.0, 0.0)}, 1.0));
}

}  // namespace
}  // namespace headway::objects
