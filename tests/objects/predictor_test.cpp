// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/objects/predictor.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <random>

#include "scene.h"

namespace headway::objects {
namespace {

using test::history;
using test::placeIn;

constexpr double kHorizon_s = kPredictionSamples * kPredictionStep_s;

std::vector<TrajectoryPoint> straightAt(double speed) {
  return history([=](double t) { return Eigen::Vector2d(3.0 + speed * t, -1.0); });
}

class EveryPredictorTest : public ::testing::TestWithParam<std::string> {
 protected:
  [[nodiscard]] std::vector<PredictedPath> predict(
      const std::vector<TrajectoryPoint>& path,
      ObjectClass object_class = ObjectClass::kCar) const {
    return predictor_->predict({object_class, path});
  }

 private:
  std::unique_ptr<Predictor> predictor_ =
      makePredictor(predictorKindFrom(GetParam()), PredictorParams());
};

INSTANTIATE_TEST_SUITE_P(Named, EveryPredictorTest, ::testing::ValuesIn(predictorNames()),
                         [](const auto& test) { return test.param; });

TEST_P(EveryPredictorTest, ContinuesAStraightPathAtItsSpeed) {
  for (const ObjectClass object_class : {ObjectClass::kCar, ObjectClass::kPedestrian}) {
    const auto paths = predict(straightAt(2.0), object_class);
    ASSERT_FALSE(paths.empty());
    for (const double t : {0.1, 1.0, 3.0}) {
      EXPECT_NEAR(placeIn(paths.front(), t).x(), 3.0 + 2.0 * t, 0.05 + 0.05 * t);
      EXPECT_NEAR(placeIn(paths.front(), t).y(), -1.0, 1e-6);
    }
  }
}

TEST_P(EveryPredictorTest, GivesThirtySamplesATenthOfASecondApart) {
  for (const PredictedPath& path : predict(straightAt(5.0))) {
    ASSERT_EQ(path.points.size(), 30u);
    for (int j = 0; j < kPredictionSamples; ++j) {
      EXPECT_DOUBLE_EQ(path.points[j].horizon_s, (j + 1) * 0.1);
      EXPECT_DOUBLE_EQ(path.points[j].position.z(), 0.7) << "z is held";
    }
  }
}

TEST_P(EveryPredictorTest, GivesProbabilitiesThatFallAndSumToOne) {
  for (const double speed : {0.0, 1.0, 12.0}) {
    double sum = 0.0;
    double before = 1.0;
    for (const PredictedPath& path : predict(straightAt(speed))) {
      EXPECT_LE(path.probability, before + 1e-12);
      before = path.probability;
      sum += path.probability;
    }
    EXPECT_NEAR(sum, 1.0, 1e-9);
  }
}

TEST_P(EveryPredictorTest, IsLessSureFartherAhead) {
  const auto turning = history([](double t) {
    return Eigen::Vector2d(20.0 * std::sin(0.3 * t), 20.0 - 20.0 * std::cos(0.3 * t));
  });
  for (const PredictedPath& path : predict(turning)) {
    double before = 0.0;
    for (const PredictedPoint& point : path.points) {
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> spread(point.covariance);
      EXPECT_GT(spread.eigenvalues()(0), 0.0) << "a covariance is positive definite";
      EXPECT_GE(point.covariance.trace(), before);
      before = point.covariance.trace();
    }
  }
}

TEST_P(EveryPredictorTest, KeepsAStaticObjectAtItsPosition) {
  const auto paths = predict(history([](double) { return Eigen::Vector2d(4.0, 5.0); }));
  ASSERT_FALSE(paths.empty());
  for (const PredictedPoint& point : paths.front().points) {
    EXPECT_NEAR((point.position.head<2>() - Eigen::Vector2d(4.0, 5.0)).norm(), 0.0, 1e-6);
  }
}

TEST_P(EveryPredictorTest, TurnsAndShiftsWithItsHistory) {
  const auto path = history(
      [](double t) { return Eigen::Vector2d(6.0 * t + 0.4 * t * t, 0.5 * t * t - 0.1 * t); });
  const double angle = 2.1;
  const Eigen::Rotation2Dd turn(angle);
  const Eigen::Vector2d shift(100.0, -40.0);
  auto moved = path;
  for (TrajectoryPoint& point : moved) {
    point.position.head<2>() = turn * point.position.head<2>() + shift;
    point.yaw = wrapAngle(point.yaw + angle);
  }
  const auto here = predict(path);
  const auto there = predict(moved);
  ASSERT_EQ(here.size(), there.size());
  for (std::size_t m = 0; m < here.size(); ++m) {
    for (int j = 0; j < kPredictionSamples; ++j) {
      const PredictedPoint& a = here[m].points[j];
      const PredictedPoint& b = there[m].points[j];
      EXPECT_LT((turn * a.position.head<2>() + shift - b.position.head<2>()).norm(), 1e-6);
      const Eigen::Matrix2d R = turn.toRotationMatrix();
      EXPECT_LT((R * a.covariance * R.transpose() - b.covariance).norm(),
                1e-6 * a.covariance.norm());
    }
  }
}

TEST_P(EveryPredictorTest, AcceptsShortHistories) {
  EXPECT_TRUE(predict({}).empty());
  const auto path = straightAt(2.0);
  for (std::size_t length = 1; length < path.size(); ++length) {
    const std::vector<TrajectoryPoint> recent(path.end() - static_cast<std::ptrdiff_t>(length),
                                              path.end());
    const auto paths = predict(recent);
    ASSERT_FALSE(paths.empty());
    const double expected = length == 1 ? 3.0 : 9.0;
    EXPECT_NEAR(placeIn(paths.front(), kHorizon_s).x(), expected, 0.4) << length << " places";
  }
}

TEST_P(EveryPredictorTest, IsFiniteForUnevenTimes) {
  auto path = history([](double t) { return Eigen::Vector2d(3.0 * t, std::sin(t)); });
  path.front().time = -60.0;
  path[18].time = -1e-6;
  path[19].time = -5e-7;
  for (const PredictedPath& predicted : predict(path)) {
    for (const PredictedPoint& point : predicted.points) {
      EXPECT_TRUE(point.position.allFinite());
      EXPECT_TRUE(point.covariance.allFinite());
    }
  }
}

TEST(PredictorNamesTest, FitTheKinds) {
  EXPECT_EQ(predictorKindFrom("paper"), PredictorKind::kPaper);
  EXPECT_EQ(predictorKindFrom("mixture"), PredictorKind::kMixture);
  EXPECT_THROW((void)predictorKindFrom("crystal_ball"), InputError);
}

TEST(ConstantTurnTest, StaysOnItsCircle) {
  const double radius = 15.0;
  const double rate = 0.4;
  const auto path = history([=](double t) {
    return Eigen::Vector2d(radius * std::sin(rate * t), radius - radius * std::cos(rate * t));
  });
  const auto predictor = makePredictor(PredictorKind::kConstantTurn, PredictorParams());
  const auto paths = predictor->predict({ObjectClass::kCar, path});
  for (const PredictedPoint& point : paths.front().points) {
    const Eigen::Vector2d centre(0.0, radius);
    EXPECT_NEAR((point.position.head<2>() - centre).norm(), radius, 0.02 * radius);
  }
  EXPECT_NEAR(placeIn(paths.front(), 3.0).x(), radius * std::sin(rate * 3.0), 0.3);
}

}  // namespace
}  // namespace headway::objects
