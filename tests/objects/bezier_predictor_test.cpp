// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "paper_predictors.h"
#include "scene.h"

namespace headway::objects {
namespace {

using test::history;

// Share of the arc length before parameter t, by brute force.
double lengthUpTo(const Eigen::Vector2d& s, const Eigen::Vector2d& c, const Eigen::Vector2d& e,
                  double t) {
  constexpr int kSteps = 20000;
  double length = 0.0;
  Eigen::Vector2d before = s;
  for (int i = 1; i <= kSteps; ++i) {
    const double u = t * i / kSteps;
    const Eigen::Vector2d here = (1 - u) * (1 - u) * s + 2 * u * (1 - u) * c + u * u * e;
    length += (here - before).norm();
    before = here;
  }
  return length;
}

TEST(BezierCurveTest, IsWalkedAtConstantSpeed) {
  const Eigen::Vector2d start(1.0, 2.0);
  for (const double bend : {0.0, 0.1, 0.5, 1.0, 2.0, 3.0, 3.14159}) {
    const Eigen::Vector2d control = start + Eigen::Vector2d(5.0, 0.0);
    const Eigen::Vector2d end = start + 9.0 * Eigen::Vector2d(std::cos(bend), std::sin(bend));
    const BezierCurve curve(start, control, end);
    const double length = lengthUpTo(start, control, end, 1.0);
    EXPECT_NEAR(curve.length(), length, 2e-3 * length) << "bend " << bend;
    for (const double fraction : {0.1, 0.5, 0.9}) {
      const double walked = lengthUpTo(start, control, end, curve.parameterAt(fraction));
      EXPECT_NEAR(walked / length, fraction, 4e-3) << "bend " << bend;
    }
    EXPECT_LT((curve.at(0.0) - start).norm(), 1e-9);
    EXPECT_LT((curve.at(1.0) - end).norm(), 1e-9);
  }
}

TEST(BezierCurveTest, OfNoLengthStaysInItsPlace) {
  const Eigen::Vector2d here(3.0, 4.0);
  const BezierCurve curve(here, here, here);
  EXPECT_EQ(curve.length(), 0.0);
  EXPECT_EQ(curve.at(0.5), here);
}

TEST(ChordOfArcTest, FollowsEquationThree) {
  const double length = 12.0;
  for (const double alpha : {0.2, 1.0, 2.0, 3.0}) {
    const double radius = length / (2.0 * alpha);
    const double x = std::cos(M_PI - 2.0 * alpha) + 1.0;
    const double y = std::sin(M_PI - 2.0 * alpha);
    EXPECT_NEAR(chordOfArc(length, alpha), radius * std::hypot(x, y), 1e-9);
  }
  EXPECT_NEAR(chordOfArc(length, 1e-5), length, 1e-6) << "eq. (2) is its limit";
}

TEST(SmoothedSpeedTest, AveragesTheLastStepsOnly) {
  auto path = history([](double t) { return Eigen::Vector2d(2.0 * t, 0.0); });
  path.front().position.x() -= 100.0;  // a jump, 20 steps ago
  PaperPredictorParams params;
  EXPECT_NEAR(smoothedSpeed(path, 0.5, params), 2.0, 1e-3);
  EXPECT_GT(smoothedSpeed(path, 2.0, params), 40.0);
  params.speed_factor = 0.5;
  EXPECT_NEAR(smoothedSpeed(path, 0.5, params), 1.0, 1e-3);
}

std::vector<PredictedPath> predictTurning(PredictorKind kind, double yaw_error = 0.0) {
  auto path = history([](double t) {
    return Eigen::Vector2d(10.0 * std::sin(0.6 * t), 10.0 - 10.0 * std::cos(0.6 * t));
  });
  for (TrajectoryPoint& point : path) point.yaw += yaw_error;
  return makePredictor(kind, PredictorParams())->predict({ObjectClass::kCar, path});
}

double reach(const std::vector<PredictedPath>& paths) {
  return paths.front().points.back().position.head<2>().norm();  // the history ends at the origin
}

TEST(BezierPredictorTest, PutsTheEndOfATurnNearerThanItsLength) {
  const double full = reach(predictTurning(PredictorKind::kPaper));
  EXPECT_LT(full, reach(predictTurning(PredictorKind::kPaperDm))) << "DM always goes |C_p| far";
  EXPECT_NEAR(reach(predictTurning(PredictorKind::kPaperDm)), 6.0 * 3.0, 0.1);
}

TEST(BezierPredictorTest, IsHardlyMovedByAWrongHeadingAndItsAblationHdIs) {
  const auto starts = [](const std::vector<PredictedPath>& paths) {
    const Eigen::Vector3d& early = paths.front().points[4].position;
    return std::atan2(early.y(), early.x());
  };
  const double error = 0.8;
  const double moved = std::abs(starts(predictTurning(PredictorKind::kPaper, error)) -
                                starts(predictTurning(PredictorKind::kPaper)));
  const double moved_hd = std::abs(starts(predictTurning(PredictorKind::kPaperHd, error)) -
                                   starts(predictTurning(PredictorKind::kPaperHd)));
  EXPECT_LT(moved, 0.1);
  EXPECT_GT(moved_hd, 0.4);
}

TEST(BezierPredictorTest, IgnoresABackwardHeading) {
  const auto paths = predictTurning(PredictorKind::kPaper, M_PI);
  const auto straight = predictTurning(PredictorKind::kPaper);
  EXPECT_LT((paths.front().points[9].position - straight.front().points[9].position).norm(), 0.2);
}

TEST(BezierPredictorTest, AblationSvUsesTheSpeedOfTheLastStep) {
  const auto path = history([](double t) { return Eigen::Vector2d(4.0 * t + t * t, 0.0); });
  const MotionHistory known{ObjectClass::kCar, path};
  const auto smoothed = makePredictor(PredictorKind::kPaper, PredictorParams())->predict(known);
  const auto instant = makePredictor(PredictorKind::kPaperSv, PredictorParams())->predict(known);
  EXPECT_NEAR(instant.front().points.back().position.x(), 3.9 * 3.0, 0.05);
  EXPECT_NEAR(smoothed.front().points.back().position.x(), 2.0 * 3.0, 0.05) << "lags behind";
}

}  // namespace
}  // namespace headway::objects
