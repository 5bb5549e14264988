// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/box_overlap.h>

#include <limits>
#include <random>

namespace headway {
namespace {

Box3d boxAt(double x, double y, double z, double yaw = 0.0) {
  Box3d box;
  box.centre = {x, y, z};
  box.length = 4.0;
  box.width = 2.0;
  box.height = 1.5;
  box.yaw = yaw;
  return box;
}

bool covers(const Footprint& f, const Eigen::Vector2d& point) {
  const Eigen::Vector2d d = point - f.centre;
  const double along = std::cos(f.yaw) * d.x() + std::sin(f.yaw) * d.y();
  const double across = -std::sin(f.yaw) * d.x() + std::cos(f.yaw) * d.y();
  return std::abs(along) <= 0.5 * f.length && std::abs(across) <= 0.5 * f.width;
}

TEST(BoxOverlapTest, ImageBoxesMatchHandComputedValues) {
  EXPECT_DOUBLE_EQ(1.0, overlap2d({0, 0, 2, 2}, {0, 0, 2, 2}));
  EXPECT_DOUBLE_EQ(1.0 / 7.0, overlap2d({0, 0, 2, 2}, {1, 1, 3, 3}));
  EXPECT_DOUBLE_EQ(0.0, overlap2d({0, 0, 2, 2}, {2, 0, 4, 2}));
  EXPECT_DOUBLE_EQ(0.0, overlap2d({0, 0, 0, 0}, {0, 0, 2, 2}));
  EXPECT_DOUBLE_EQ(0.25, ratioInside({0, 0, 2, 2}, {1, 1, 9, 9}));
  EXPECT_DOUBLE_EQ(0.0, ratioInside({1, 1, 1, 1}, {0, 0, 2, 2}));
}

TEST(BoxOverlapTest, UprightBoxesMatchHandComputedValues) {
  EXPECT_NEAR(1.0, overlap3d(boxAt(0, 0, 0), boxAt(0, 0, 0)), 1e-12);
  EXPECT_NEAR(1.0 / 3.0, overlap3d(boxAt(0, 0, 0), boxAt(2, 0, 0)), 1e-12);
  EXPECT_NEAR(1.0 / 3.0, overlap3d(boxAt(0, 0, 0), boxAt(0, 0.75, 0)), 1e-12);
  // Across each other: 2 x 2 of 4 x 2 each.
  EXPECT_NEAR(4.0 / 12.0, overlap3d(boxAt(0, 0, 9), boxAt(0, 0, 9, M_PI / 2)), 1e-12);
  EXPECT_EQ(0.0, overlap3d(boxAt(0, 0, 0), boxAt(0, 1.5, 0)));
  EXPECT_EQ(0.0, overlap3d(boxAt(0, 0, 0), boxAt(0, 0, 2.0)));
}

TEST(BoxOverlapTest, YawTurnsTheFrontTowardsMinusZ) {
  // Turned by 45 degrees the box reaches along (1, -1) in x and z, not along (1, 1).
  const Box3d turned = boxAt(0, 0, 0, M_PI / 4);
  Box3d probe = boxAt(1.2, 0, -1.2);
  probe.length = probe.width = 0.1;
  EXPECT_GT(overlap3d(turned, probe), 0.0);
  probe.centre.z() = 1.2;
  EXPECT_EQ(0.0, overlap3d(turned, probe));
}

TEST(BoxOverlapTest, AreaMatchesMonteCarlo) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int repeat = 0; repeat < 30; ++repeat) {
    const Footprint a{
        {unit(random), unit(random)}, 1 + unit(random), 1 + unit(random), 7 * unit(random)};
    const Footprint b{
        {unit(random), unit(random)}, 1 + unit(random), 1 + unit(random), 7 * unit(random)};
    constexpr int kCells = 400;
    int hits = 0;
    for (int i = 0; i < kCells; ++i) {
      for (int j = 0; j < kCells; ++j) {
        const Eigen::Vector2d point(-2 + 5 * (i + 0.5) / kCells, -2 + 5 * (j + 0.5) / kCells);
        if (covers(a, point) && covers(b, point)) ++hits;
      }
    }
    EXPECT_NEAR(25.0 * hits / (kCells * kCells), intersectionArea(a, b), 0.02);
    EXPECT_NEAR(intersectionArea(a, b), intersectionArea(b, a), 1e-12);
  }
}

TEST(BoxOverlapTest, NonFiniteBoxesDoNotOverlap) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(0.0, overlap3d(boxAt(nan, 0, 0), boxAt(0, 0, 0)));
  EXPECT_EQ(0.0, overlap2d({nan, 0, 2, 2}, {0, 0, 2, 2}));
}

}  // namespace
}  // namespace headway
