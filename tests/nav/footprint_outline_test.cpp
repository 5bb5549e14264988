// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/nav/moving_obstacles.h>

#include <Eigen/Geometry>

namespace headway::nav {
namespace {

using Eigen::Vector2d;

const map::FootprintShape kCar{4.0, 2.0, false};
const map::FootprintShape kPerson{0.6, 0.4, true};

PlaceUncertainty uncertaintyOf(double sigma_m) {
  PlaceUncertainty uncertainty;
  uncertainty.covariance = sigma_m * sigma_m * Eigen::Matrix2d::Identity();
  uncertainty.max_growth_m = 10.0;
  return uncertainty;
}

std::vector<Vector2d> outlineOf(const map::FootprintShape& footprint, double yaw,
                                const PlaceUncertainty& uncertainty) {
  std::vector<Vector2d> outline;
  appendOutline(footprint, Vector2d(3.0, -1.0), yaw, uncertainty, 0.2, outline);
  return outline;
}

TEST(FootprintOutlineTest, OfACertainCarRunsAlongItsEdges) {
  for (const auto& point : outlineOf(kCar, 0.0, uncertaintyOf(0.0))) {
    const Vector2d local = (point - Vector2d(3.0, -1.0)).cwiseAbs();
    const bool on_end = std::abs(local.x() - 2.0) < 1e-9 && local.y() <= 1.0 + 1e-9;
    const bool on_side = std::abs(local.y() - 1.0) < 1e-9 && local.x() <= 2.0 + 1e-9;
    EXPECT_TRUE(on_end || on_side) << point.transpose();
  }
}

TEST(FootprintOutlineTest, NeighboursAreWithinTheSpacing) {
  const auto outline = outlineOf(kCar, 0.4, uncertaintyOf(0.3));
  for (std::size_t i = 0; i < outline.size(); ++i) {
    EXPECT_LE((outline[i] - outline[(i + 1) % outline.size()]).norm(), 0.3 + 1e-9);
  }
}

TEST(FootprintOutlineTest, GrowsWithTheUncertainty) {
  const auto certain = outlineOf(kPerson, 0.3, uncertaintyOf(0.0));
  const auto uncertain = outlineOf(kPerson, 0.3, uncertaintyOf(0.25));
  const auto farthest = [](const std::vector<Vector2d>& outline) {
    double radius = 0.0;
    for (const auto& point : outline) {
      radius = std::max(radius, (point - Vector2d(3.0, -1.0)).norm());
    }
    return radius;
  };
  EXPECT_NEAR(farthest(uncertain), farthest(certain) + 0.25, 0.02);
}

TEST(FootprintOutlineTest, GrowsAlongTheCovarianceOnly) {
  PlaceUncertainty along_x = uncertaintyOf(0.0);
  along_x.covariance(0, 0) = 1.0;
  double right = 0.0, top = 0.0;
  for (const auto& point : outlineOf(kCar, 0.0, along_x)) {
    right = std::max(right, point.x() - 3.0);
    top = std::max(top, point.y() + 1.0);
  }
  EXPECT_NEAR(right, 3.0, 0.05);
  EXPECT_NEAR(top, 1.0, 1e-9);
}

TEST(FootprintOutlineTest, GrowsUpToTheLimit) {
  PlaceUncertainty uncertainty = uncertaintyOf(100.0);
  uncertainty.max_growth_m = 0.4;
  for (const auto& point : outlineOf(kPerson, 0.0, uncertainty)) {
    EXPECT_LE((point - Vector2d(3.0, -1.0)).norm(), kPerson.radius() + 0.4 + 1e-9);
  }
}

TEST(FootprintOutlineTest, RotatesWithTheFootprint) {
  const auto straight = outlineOf(kCar, 0.0, uncertaintyOf(0.1));
  const auto turned = outlineOf(kCar, 0.7, uncertaintyOf(0.1));
  ASSERT_EQ(straight.size(), turned.size());
  const Vector2d centre(3.0, -1.0);
  for (std::size_t i = 0; i < straight.size(); ++i) {
    const Vector2d expected = centre + Eigen::Rotation2Dd(0.7) * (straight[i] - centre);
    EXPECT_LT((turned[i] - expected).norm(), 1e-9);
  }
}

TEST(FootprintOutlineTest, CoversTheMarginOnly) {
  const Vector2d centre(1.0, 1.0);
  EXPECT_TRUE(covers(kCar, centre, M_PI / 2.0, 0.1, {1.0, 3.05}));
  EXPECT_FALSE(covers(kCar, centre, M_PI / 2.0, 0.1, {1.0, 3.15}));
  EXPECT_FALSE(covers(kCar, centre, M_PI / 2.0, 0.1, {3.0, 1.0}));
}

TEST(FootprintOutlineTest, PeopleAreRoundAndCarsAreNot) {
  Track track;
  track.size = {4.0, 2.0, 1.5};
  EXPECT_FALSE(map::footprintOf(track).round) << "an unknown object takes the larger shape";
  track.object_class = ObjectClass::kCar;
  EXPECT_FALSE(map::footprintOf(track).round);
  EXPECT_NEAR(map::footprintOf(track).radius(), std::sqrt(5.0), 1e-12);
  track.object_class = ObjectClass::kPedestrian;
  EXPECT_TRUE(map::footprintOf(track).round);
  EXPECT_DOUBLE_EQ(map::footprintOf(track).radius(), 2.0);
}

}  // namespace
}  // namespace headway::nav
