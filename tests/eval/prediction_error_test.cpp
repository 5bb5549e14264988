// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/eval/figures.h>
#include <headway/eval/prediction_error.h>

#include <nlohmann/json.hpp>
#include <random>
#include <stdexcept>

namespace headway::eval {
namespace {

/// A path along x at `speed`, shifted by `offset`, with a round covariance.
PredictedPath pathAt(double speed, double offset, double variance = 1.0, double probability = 1.0) {
  PredictedPath path;
  path.probability = probability;
  for (std::size_t j = 0; j < kHorizons; ++j) {
    PredictedPoint point;
    point.horizon_s = kHorizonStep_s * static_cast<double>(j + 1);
    point.position = {speed * point.horizon_s, offset, 0.7};
    point.covariance = variance * Eigen::Matrix2d::Identity();
    path.points.push_back(point);
  }
  return path;
}

HorizonPath futureAt(double speed) {
  HorizonPath future;
  for (std::size_t j = 0; j < kHorizons; ++j) {
    future[j] = {speed * kHorizonStep_s * static_cast<double>(j + 1), 0.0};
  }
  return future;
}

PredictionError evaluateOne(const std::vector<PredictedPath>& paths, const HorizonPath& future) {
  PredictionEvaluator evaluator;
  evaluator.add(ObjectClass::kCar, paths, future);
  return evaluator.errors().all;
}

TEST(PredictionErrorTest, MatchesAHandComputedCase) {
  // 1 m/s too fast: errors 0.1, 0.2 .. 3.0 m; mean 1.55, 2 m exceeded at 2.1 s.
  const auto error = evaluateOne({pathAt(6.0, 0.0)}, futureAt(5.0));
  EXPECT_EQ(1u, error.cases);
  EXPECT_NEAR(1.55, error.ade_m.value(), 1e-12);
  EXPECT_NEAR(3.0, error.fde_m.value(), 1e-12);
  EXPECT_NEAR(1.55, error.best_of_k_ade_m.value(), 1e-12);
  EXPECT_EQ(0.0, error.miss_rate[0].value());
  EXPECT_EQ(0.0, error.miss_rate[1].value()) << "2.0 m is no miss";
  EXPECT_EQ(1.0, error.miss_rate[2].value());
  // Squared errors 1, 4, 9 at 1, 2, 3 s against limits 1.386, 4.605, 5.991.
  EXPECT_EQ(1.0, error.coverage[0][0].value());
  EXPECT_EQ(0.0, error.coverage[0][1].value());
  EXPECT_EQ(1.0, error.coverage[1][1].value());
  EXPECT_EQ(0.0, error.coverage[2][2].value());
  EXPECT_NEAR(9455.0 / 100.0 / 30.0, error.nees.value(), 1e-9);  // sum of k^2, k to 30: 9455
  EXPECT_NEAR(1.0, error.mean_error_m[9], 1e-12);
}

TEST(PredictionErrorTest, EvaluatesTheMostProbablePathAndTheBestOfK) {
  const auto error = evaluateOne(
      {pathAt(5.0, 0.0, 1.0, 0.3), pathAt(5.0, 1.0, 1.0, 0.6), pathAt(5.0, 3.0, 1.0, 0.1)},
      futureAt(5.0));
  EXPECT_NEAR(1.0, error.ade_m.value(), 1e-12);
  EXPECT_NEAR(0.0, error.best_of_k_ade_m.value(), 1e-12);
}

TEST(PredictionErrorTest, CoverageAndNeesAreConsistentForTrueCovariances) {
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0.0, 0.5);
  PredictionEvaluator evaluator;
  for (int i = 0; i < 20000; ++i) {
    auto future = futureAt(1.0);
    for (auto& place : future) place += Eigen::Vector2d(noise(random), noise(random));
    evaluator.add(ObjectClass::kPedestrian, {pathAt(1.0, 0.0, 0.25)}, future);
  }
  const auto error = evaluator.errors().all;
  const std::array<double, 3> expected = {0.50, 0.90, 0.95};
  for (std::size_t p = 0; p < 3; ++p) {
    for (std::size_t s = 0; s < 3; ++s) {
      EXPECT_NEAR(expected[p], error.coverage[p][s].value(), 0.012);
    }
  }
  EXPECT_NEAR(2.0, error.nees.value(), 0.02);
}

TEST(PredictionErrorTest, UsesTheDirectionOfTheCovariance) {
  auto path = pathAt(5.0, 1.0);
  for (auto& point : path.points) {
    point.covariance = Eigen::Vector2d(0.01, 4.0).asDiagonal();  // wide across only
  }
  EXPECT_EQ(1.0, evaluateOne({path}, futureAt(5.0)).coverage[0][0].value());
  EXPECT_NEAR(0.25, evaluateOne({path}, futureAt(5.0)).nees.value(), 1e-12);
}

TEST(PredictionErrorTest, ClassesAreEvaluatedSeparatelyAndTogether) {
  PredictionEvaluator evaluator;
  evaluator.add(ObjectClass::kCar, {pathAt(5.0, 1.0)}, futureAt(5.0));
  PredictionEvaluator other;
  other.add(ObjectClass::kCar, {pathAt(5.0, 3.0)}, futureAt(5.0));
  other.add(ObjectClass::kPedestrian, {pathAt(1.0, 0.0)}, futureAt(1.0));
  evaluator.add(other);
  const auto errors = evaluator.errors();
  EXPECT_NEAR(2.0, errors.classes.at(ObjectClass::kCar).ade_m.value(), 1e-12);
  EXPECT_NEAR(0.0, errors.classes.at(ObjectClass::kPedestrian).ade_m.value(), 1e-12);
  EXPECT_NEAR(4.0 / 3.0, errors.all.ade_m.value(), 1e-12);
  EXPECT_EQ(3u, errors.all.cases);
}

TEST(PredictionErrorTest, HasNoCoverageWithoutCovariance) {
  const auto error = evaluateOne({pathAt(5.0, 0.0, 0.0)}, futureAt(5.0));
  EXPECT_FALSE(error.coverage[0][0] || error.nees);
  EXPECT_TRUE(error.ade_m.has_value());
}

TEST(PredictionErrorTest, HasNoFiguresWithoutCases) {
  const auto errors = PredictionEvaluator().errors();
  EXPECT_TRUE(errors.classes.empty());
  EXPECT_FALSE(errors.all.ade_m || errors.all.miss_rate[0] || errors.all.nees);
}

TEST(PredictionErrorTest, OtherHorizonsThrow) {
  auto path = pathAt(5.0, 0.0);
  path.points.pop_back();
  EXPECT_THROW((void)evaluateOne({path}, futureAt(5.0)), std::invalid_argument);
  EXPECT_THROW((void)evaluateOne({}, futureAt(5.0)), std::invalid_argument);
  path = pathAt(5.0, 0.0);
  path.points[3].horizon_s = 0.45;
  EXPECT_THROW((void)evaluateOne({path}, futureAt(5.0)), std::invalid_argument);
}

TEST(PredictionJsonTest, HasTheDocumentedKeys) {
  PredictionEvaluator evaluator;
  evaluator.add(ObjectClass::kCar, {pathAt(5.0, 1.0)}, futureAt(5.0));
  const auto json = toJson(evaluator.errors());
  for (const char* key : {"cases", "ade_m", "fde_m", "miss_rate_1s", "miss_rate_2s", "miss_rate_3s",
                          "best_of_k_ade_m", "coverage_50_1s", "coverage_50_2s", "coverage_50_3s",
                          "coverage_90_1s", "coverage_90_2s", "coverage_90_3s", "coverage_95_1s",
                          "coverage_95_2s", "coverage_95_3s", "nees"}) {
    EXPECT_TRUE(json.at("Car").contains(key)) << key;
    EXPECT_TRUE(json.at("all").contains(key)) << key;
  }
}

}  // namespace
}  // namespace headway::eval
