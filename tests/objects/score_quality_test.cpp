// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "measurement_model.h"

namespace headway::objects {
namespace {

MeasuredBox withScore(double score, ObjectClass object_class = ObjectClass::kCar) {
  MeasuredBox box;
  box.object_class = object_class;
  box.score = score;
  box.size_sigma_m = 0.2;
  return box;
}

/// After scores of mean 100 and standard deviation 10 in class Car.
ScoreQuality learnt() {
  ScoreQuality quality;
  for (int k = 0; k < 50; ++k) {
    quality.learn(withScore(90.0));
    quality.learn(withScore(110.0));
  }
  return quality;
}

double sizeSigmaAt(double score) { return learnt().scaled(withScore(score)).size_sigma_m; }

TEST(ScoreQualityTest, ScoresAboveTheMeanCountMore) {
  EXPECT_NEAR(sizeSigmaAt(100.0), 0.2, 1e-9);
  EXPECT_NEAR(sizeSigmaAt(110.0), 0.2 / 1.4, 1e-9);
  EXPECT_NEAR(sizeSigmaAt(90.0), 0.2 * 1.4, 1e-9);
}

TEST(ScoreQualityTest, OutlyingScoresAreLimited) {
  EXPECT_DOUBLE_EQ(sizeSigmaAt(1e9), sizeSigmaAt(120.0));
  EXPECT_DOUBLE_EQ(sizeSigmaAt(-1e9), sizeSigmaAt(80.0));
}

TEST(ScoreQualityTest, TheUnitOfTheScoreDoesNotMatter) {
  ScoreQuality quality;
  for (const double score : {0.0, 1.0}) quality.learn(withScore(score));
  EXPECT_NEAR(quality.scaled(withScore(1.0)).size_sigma_m, sizeSigmaAt(110.0), 1e-9);
}

TEST(ScoreQualityTest, ADetectorWithoutScoresKeepsItsNoise) {
  ScoreQuality quality;
  EXPECT_EQ(quality.scaled(withScore(1.0)).size_sigma_m, 0.2);
  for (int k = 0; k < 9; ++k) quality.learn(withScore(1.0));
  EXPECT_EQ(quality.scaled(withScore(1.0)).size_sigma_m, 0.2);
}

TEST(ScoreQualityTest, ClassesHaveTheirOwnScores) {
  EXPECT_EQ(learnt().scaled(withScore(0.0, ObjectClass::kCyclist)).size_sigma_m, 0.2);
}

}  // namespace
}  // namespace headway::objects
