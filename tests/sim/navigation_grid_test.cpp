// SPDX-License-Identifier: BSD-3-Clause
// Laws of clearances and ways on a small floor with a wall and a door.
#include "navigation_grid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "site.h"

namespace headway::sim {
namespace {

/// 10 m x 6 m, a wall at x = 5 with a door of `door_m` at y = 4.
Site twoRooms(double door_m) {
  Site site;
  site.area = rectangle(0, 0, 10, 6);
  SiteBuilder builder(site);
  builder.wall({5, 0}, {5, 6}, 2.8, Material::kPlaster, {{4.0, door_m, 0.0, 2.1}});
  return site;
}

TEST(NavigationGridTest, ClearanceIsTheDistanceToTheNearestObstacle) {
  const NavigationGrid grid(twoRooms(1.0));
  EXPECT_NEAR(grid.clearance({4.0, 1.0}), 0.93, 0.15);
  EXPECT_EQ(grid.clearance({5.0, 1.0}), 0.0);
  EXPECT_EQ(grid.clearance({-1.0, 1.0}), 0.0);
  EXPECT_GT(grid.clearance({2.5, 3.0}), 2.0);
}

TEST(NavigationGridTest, AWayLeadsThroughTheDoorAndKeepsItsDistance) {
  const NavigationGrid grid(twoRooms(1.0));
  const Eigen::Vector2d from(1, 1), to(9, 1);
  const auto way = grid.path(from, to, 0.3);
  ASSERT_FALSE(way.empty());
  EXPECT_LT((way.back() - to).norm(), 1e-9);
  Eigen::Vector2d at = from;
  bool through_door = false;
  for (const Eigen::Vector2d& corner : way) {
    EXPECT_TRUE(grid.isClear(at, corner, 0.25));
    for (double t = 0.0; t <= 1.0; t += 0.02) {
      const Eigen::Vector2d place = at + t * (corner - at);
      through_door =
          through_door || (std::abs(place.x() - 5) < 0.1 && std::abs(place.y() - 4) < 0.4);
    }
    at = corner;
  }
  EXPECT_TRUE(through_door);
}

TEST(NavigationGridTest, WhoIsTooWideFindsNoWay) {
  const NavigationGrid grid(twoRooms(0.6));
  EXPECT_TRUE(grid.path({1, 1}, {9, 1}, 0.45).empty());
  EXPECT_TRUE(grid.path({1, 1}, {20, 1}, 0.2).empty());
}

TEST(NavigationGridTest, AFreeWayIsStraight) {
  Site site;
  site.area = rectangle(0, 0, 10, 6);
  const NavigationGrid grid(site);
  EXPECT_EQ(grid.path({1, 3}, {8, 3.5}, 0.3).size(), 1U);
}

TEST(NavigationGridTest, StandingPeopleAndTurnedBoxesBlock) {
  Site site;
  site.area = rectangle(0, 0, 10, 6);
  site.spots.push_back({{2, 2}, 0.0, false});
  site.spots.push_back({{4, 2}, 0.0, true});
  SiteBuilder(site).box({{7, 3}, M_PI / 4, {2.0, 0.2, 1.0}, 0.0}, Material::kWood);
  const NavigationGrid grid(site);
  EXPECT_EQ(grid.clearance({2, 2}), 0.0);
  EXPECT_GT(grid.clearance({4, 2}), 0.0);
  EXPECT_EQ(grid.clearance({7.5, 3.5}), 0.0);
  EXPECT_GT(grid.clearance({7.5, 2.5}), 0.3);
}

}  // namespace
}  // namespace headway::sim
