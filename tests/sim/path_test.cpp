// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "route.h"

namespace headway::sim {
namespace {

Path circle(double radius) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 720; ++i) {
    const double angle = i * M_PI / 360.0;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  }
  return Path(points, true);
}

TEST(PathTest, MeasuresArcLength) {
  EXPECT_NEAR(circle(30.0).length(), 2.0 * M_PI * 30.0, 0.01);
  EXPECT_DOUBLE_EQ(Path({{0, 0, 0}, {3, 4, 0}}).length(), 5.0);
}

TEST(PathTest, ClosedPathGoesRound) {
  const Path path = circle(30.0);
  const auto here = path.at(12.3), again = path.at(12.3 + path.length());
  EXPECT_LT((here.position - again.position).norm(), 1e-9);
  EXPECT_NEAR(std::remainder(here.yaw - again.yaw, 2.0 * M_PI), 0.0, 1e-9);
}

TEST(PathTest, OpenPathEndsAtItsEnds) {
  const Path path({{0, 0, 0}, {10, 0, 0}});
  EXPECT_LT((path.at(-5.0).position - Eigen::Vector3d(0, 0, 0)).norm(), 1e-9);
  EXPECT_LT((path.at(50.0).position - Eigen::Vector3d(10, 0, 0)).norm(), 1e-9);
}

TEST(PathTest, CurvatureOfACircleIsOneOverItsRadius) {
  const Path path = circle(25.0);
  for (double s = 0.0; s < path.length(); s += 7.7)
    EXPECT_NEAR(path.curvature(s), 1.0 / 25.0, 1e-3);
}

TEST(PathTest, ProjectionInvertsBeside) {
  const Path path = circle(40.0);
  for (const double left : {-5.0, 0.0, 3.5}) {
    const Eigen::Vector2d at = path.beside(33.3, left).head<2>();
    const auto found = path.project(at, 20.0, 50.0);
    EXPECT_NEAR(found.s, 33.3, 0.1);
    EXPECT_NEAR(found.left, left, 0.02);
  }
}

TEST(PathTest, BesidePathKeepsItsDistanceAndMayTurnRound) {
  const Path path = circle(40.0);
  const Path inner = besidePath(path, 4.0, true);  // left of an anticlockwise circle is inside
  EXPECT_NEAR(inner.length(), 2.0 * M_PI * 36.0, 0.2);
  EXPECT_LT(inner.curvature(10.0), 0.0);
}

TEST(PathTest, DirectionIsContinuousAtSamples) {
  const Path path({{0, 0, 0}, {10, 0, 0}, {20, 5, 1}, {30, 15, 1}});
  for (double s = 1.0; s < path.length() - 1.0; s += 0.25) {
    EXPECT_LT(std::abs(path.at(s + 1e-4).yaw - path.at(s - 1e-4).yaw), 1e-2) << s;
  }
}

}  // namespace
}  // namespace headway::sim
