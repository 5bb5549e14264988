// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/objects/predictor.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "scene.h"

namespace headway::objects {
namespace {

using test::history;
using test::placeIn;

TEST(MixtureTest, FollowsATurnAtFirstAndDoesNotCircleForever) {
  const double rate = 0.5;
  const auto path = history([=](double t) {
    return Eigen::Vector2d(16.0 * std::sin(rate * t), 16.0 - 16.0 * std::cos(rate * t));
  });
  const auto paths =
      makePredictor(PredictorKind::kMixture, PredictorParams())->predict({ObjectClass::kCar, path});
  const Eigen::Vector2d half(16.0 * std::sin(rate * 0.5), 16.0 - 16.0 * std::cos(rate * 0.5));
  EXPECT_LT((placeIn(paths.front(), 0.5) - half).norm(), 0.5);
  EXPECT_GT(placeIn(paths.front(), 3.0).y(), 1.0) << "it turns left";
}

TEST(MixtureTest, StopsAndDoesNotReverse) {
  // Braking at 3 m/s^2 from 7 m/s: 1 m/s is left now.
  const auto path = history([](double t) { return Eigen::Vector2d(t - 1.5 * t * t, 0.0); });
  const auto paths =
      makePredictor(PredictorKind::kMixture, PredictorParams())->predict({ObjectClass::kCar, path});
  double before = 0.0;
  for (const PredictedPoint& point : paths.front().points) {
    EXPECT_GE(point.position.x(), before - 1e-9) << "a braking car does not roll back";
    before = point.position.x();
  }
  EXPECT_LT(before, 2.0) << "constant velocity would say 3 m";
}

TEST(MixtureTest, FollowsAReversingCarBackwards) {
  auto path = history([](double t) { return Eigen::Vector2d(-1.5 * t, 0.0); });
  for (TrajectoryPoint& point : path) point.yaw = 0.0;  // it faces +x
  const auto paths =
      makePredictor(PredictorKind::kMixture, PredictorParams())->predict({ObjectClass::kCar, path});
  EXPECT_NEAR(placeIn(paths.front(), 3.0).x(), -4.5, 0.5);
}

Eigen::Matrix2d spreadAt(const MotionHistory& known, double horizon_s) {
  const auto paths = makePredictor(PredictorKind::kMixture, PredictorParams())->predict(known);
  const auto j = static_cast<std::size_t>(std::lround(horizon_s / kPredictionStep_s)) - 1;
  return paths.front().points.at(j).covariance;
}

MotionHistory drivingAlongX(double span_s) {
  MotionHistory known;
  known.object_class = ObjectClass::kCar;
  known.path = history([](double t) { return Eigen::Vector2d(8.0 * t, 0.0); }, span_s);
  return known;
}

TEST(MixturePredictorTest, IsLessSureInTheDirectionInWhichTheHistoryIsNoisy) {
  const MotionHistory exact = drivingAlongX(2.0);
  MotionHistory noisy = exact;
  noisy.position_covariance.diagonal() << 0.25, 0.01;
  for (const double t : {0.1, 1.0, 3.0}) {
    const Eigen::Matrix2d gained = spreadAt(noisy, t) - spreadAt(exact, t);
    EXPECT_GT(gained(0, 0), 0.25) << "an error of place is one of speed, too, after " << t;
    EXPECT_GT(gained(1, 1), 0.01) << t;
    EXPECT_GT(gained(0, 0), 3.0 * gained(1, 1)) << t;
  }
}

TEST(MixturePredictorTest, IsLessCertainForShortHistories) {
  double before = 0.0;
  for (const double span : {2.0, 1.0, 0.5, 0.2, 0.0}) {
    MotionHistory known = drivingAlongX(span);
    known.position_covariance = 0.04 * Eigen::Matrix2d::Identity();
    const double spread = spreadAt(known, 1.0).trace();
    EXPECT_GT(spread, before) << span;
    before = spread;
  }
  const double typical = PredictorParams().manoeuvres.typical_speed_mps.vehicle;
  EXPECT_NEAR(before, 2.0 * typical * typical, 0.02 * typical * typical)
      << "of a car seen once nothing is known but how fast cars are";
}

TEST(MixturePredictorTest, SpreadIsThatOfItsErrorsWhateverThePathsLength) {
  const Eigen::Vector2d sigma(0.3, 0.1);
  std::mt19937 random(5);
  std::normal_distribution<double> noise;
  for (const double span : {0.3, 0.6, 1.0, 2.0}) {
    int inside = 0;
    constexpr int kPaths = 400;
    for (int n = 0; n < kPaths; ++n) {
      MotionHistory known = drivingAlongX(span);
      known.position_covariance = sigma.cwiseAbs2().asDiagonal();
      for (auto& point : known.path) {
        point.position.x() += sigma.x() * noise(random);
        point.position.y() += sigma.y() * noise(random);
      }
      const auto paths = makePredictor(PredictorKind::kMixture, PredictorParams())->predict(known);
      const Eigen::Vector2d error = placeIn(paths.front(), 1.0) - Eigen::Vector2d(8.0, 0.0);
      constexpr double kNinetyPercent = 4.605;  // chi-square, two degrees of freedom
      inside += error.dot(spreadAt(known, 1.0).inverse() * error) < kNinetyPercent ? 1 : 0;
    }
    EXPECT_GT(inside, 0.80 * kPaths) << span;
  }
}

double probabilityOf(int mode, const MotionHistory& known) {
  for (const auto& path :
       makePredictor(PredictorKind::kMixture, PredictorParams())->predict(known)) {
    if (path.mode == mode) return path.probability;
  }
  return -1.0;
}

MotionHistory carOn(const std::function<Eigen::Vector2d(double)>& place) {
  MotionHistory known;
  known.object_class = ObjectClass::kCar;
  known.path = history(place, 4.0);
  return known;
}

TEST(MixturePredictorTest, WhoHasTurnedIsNotMeasuredByWhereHeCameFrom) {
  // 1.2 m/s along x until half a second ago, along y since.
  const auto corner = history([](double t) {
    return Eigen::Vector2d(1.2 * std::min(t, -0.5), 1.2 * std::max(0.0, t + 0.5));
  });
  const auto predictor = makePredictor(PredictorKind::kMixture, PredictorParams());
  const auto after = predictor->predict({ObjectClass::kPedestrian, corner});
  const Eigen::Vector2d ahead = placeIn(after.front(), 1.0) - corner.back().position.head<2>();
  EXPECT_NEAR(ahead.y(), 1.2, 0.3);
  EXPECT_NEAR(ahead.x(), 0.0, 0.4);
  PredictorParams patient;
  patient.manoeuvres.shortest_memory_s = patient.manoeuvres.memory_s;
  const auto sway =
      history([](double t) { return Eigen::Vector2d(1.2 * t, 0.03 * std::sin(2.0 * M_PI * t)); });
  EXPECT_EQ(placeIn(predictor->predict({ObjectClass::kPedestrian, sway}).front(), 3.0),
            placeIn(makePredictor(PredictorKind::kMixture, patient)
                        ->predict({ObjectClass::kPedestrian, sway})
                        .front(),
                    3.0))
      << "a gait is no turn";
}

/// 1.3 m/s after a second are within the 90 % ellipse of who stands, not of a parked car.
TEST(MixturePredictorTest, AStandingPersonMaySetOff) {
  MotionHistory known = carOn([](double) { return Eigen::Vector2d(2.0, 1.0); });
  const double parked = std::sqrt(spreadAt(known, 1.0)(0, 0));
  known.object_class = ObjectClass::kPedestrian;
  const double standing = std::sqrt(spreadAt(known, 1.0)(0, 0));
  EXPECT_LT(parked, 0.35 * standing);
  EXPECT_GT(2.146 * standing, 0.65) << "halfway, for who sets off in the middle";
  known.path = history([](double t) { return Eigen::Vector2d(1.3 * t, 0.0); }, 4.0);
  EXPECT_LT(std::sqrt(spreadAt(known, 1.0)(0, 0)), 0.5 * standing) << "who walks goes on";
}

TEST(HindsightTest, PrefersThePathsThatCameTrue) {
  constexpr int kPresentMotion = 0;
  constexpr int kStraight = 1;
  const auto circling = carOn([](double t) {
    return Eigen::Vector2d(15.0 * std::sin(0.6 * t), 15.0 - 15.0 * std::cos(0.6 * t));
  });
  EXPECT_GT(probabilityOf(kPresentMotion, circling), 0.58);
  EXPECT_LT(probabilityOf(kStraight, circling), 0.22);

  const auto out_of_its_turn = carOn([](double t) {
    const double angle = 0.6 * std::min(0.0, t + 0.8);
    const Eigen::Vector2d turning(15.0 * std::sin(angle), 15.0 - 15.0 * std::cos(angle));
    return Eigen::Vector2d(turning + Eigen::Vector2d(9.0 * std::max(0.0, t + 0.8), 0.0));
  });
  EXPECT_LT(probabilityOf(kPresentMotion, out_of_its_turn), 0.52);
  EXPECT_GT(probabilityOf(kStraight, out_of_its_turn), 0.28);

  const auto standing = carOn([](double) { return Eigen::Vector2d(2.0, 1.0); });
  EXPECT_DOUBLE_EQ(probabilityOf(kPresentMotion, standing), 0.55) << "all paths say the same";
  EXPECT_DOUBLE_EQ(probabilityOf(kStraight, standing), 0.25);
}

TEST(HindsightTest, IsLessSureOfWhatHasSurprised) {
  const auto steady = carOn([](double t) { return Eigen::Vector2d(8.0 * t, 0.0); });
  const auto braking = carOn([](double t) {
    const double since = std::max(0.0, t + 0.6);  // from then on by 6 m/s^2
    return Eigen::Vector2d(8.0 * t - 3.0 * since * since, 0.0);
  });
  const auto area = [](const MotionHistory& known, double horizon_s) {
    return std::sqrt(spreadAt(known, horizon_s).determinant());
  };
  EXPECT_GT(area(braking, 1.0), 2.0 * area(steady, 1.0));
  EXPECT_LT(area(braking, 3.0) / area(steady, 3.0), area(braking, 1.0) / area(steady, 1.0))
      << "by then something else may come";
}

TEST(HindsightTest, IsRobustAgainstOneWildPosition) {
  auto path = carOn([](double t) { return Eigen::Vector2d(8.0 * t, 0.0); });
  const double usual = spreadAt(path, 1.0).trace();
  path.path.back().position.y() += 100.0;
  for (const double t : {0.1, 1.0, 3.0}) EXPECT_TRUE(spreadAt(path, t).allFinite());
  EXPECT_LT(probabilityOf(0, path), 1.0);
  path.path.back().position.y() = 0.4;
  EXPECT_LT(spreadAt(path, 1.0).trace(), 20.0 * usual);
}

}  // namespace
}  // namespace headway::objects
