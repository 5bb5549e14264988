// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <random>

#include "consistency.h"

namespace headway::objects {
namespace {

struct Placed {
  Eigen::Vector3d position;
};

std::vector<Placed> randomPlaces(int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-50.0, 50.0);
  std::vector<Placed> places;
  for (int i = 0; i < count; ++i) {
    places.push_back({{coordinate(random), coordinate(random), coordinate(random)}});
  }
  return places;
}

std::vector<std::size_t> visitedNear(const SpatialGrid& grid, const Eigen::Vector2d& position) {
  std::vector<std::size_t> visited;
  grid.visitNear(position, [&visited](std::size_t i) { visited.push_back(i); });
  return visited;
}

TEST(SpatialGridTest, VisitsEveryPositionWithinACellOnce) {
  const auto places = randomPlaces(400);
  constexpr double kCell_m = 6.0;
  const SpatialGrid grid(places, kCell_m);
  for (const auto& centre : randomPlaces(50)) {
    const auto visited = visitedNear(grid, centre.position.head<2>());
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double distance = (places[i].position - centre.position).head<2>().norm();
      const auto visits = std::count(visited.begin(), visited.end(), i);
      if (distance <= kCell_m) {
        EXPECT_EQ(visits, 1) << i;
      } else if (distance > 3.0 * kCell_m) {
        EXPECT_EQ(visits, 0) << i;
      }
    }
  }
}

TEST(SpatialGridTest, VisitsExactlyThePositionsWithinARadius) {
  constexpr double kCell_m = 6.0;
  const auto places = randomPlaces(300);
  const SpatialGrid grid(places, kCell_m);
  for (const auto& place : places) {
    std::vector<std::size_t> visited, expected;
    const Eigen::Vector2d position = place.position.head<2>();
    grid.visitWithin(position, 0.6 * kCell_m, [&](std::size_t i) { visited.push_back(i); });
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double distance = (places[i].position.head<2>() - position).norm();
      if (distance <= 0.6 * kCell_m) expected.push_back(i);
    }
    std::sort(visited.begin(), visited.end());
    EXPECT_EQ(expected, visited);
  }
}

TEST(SpatialGridTest, VisitsFewerPositionsThanThereAre) {
  const auto places = randomPlaces(400);
  const SpatialGrid grid(places, 2.0);
  EXPECT_LT(visitedNear(grid, {0.0, 0.0}).size(), 20u);
}

TEST(SpatialGridTest, AcceptsFarPositions) {
  const std::vector<Placed> places = {{{1e15, -1e15, 0.0}}, {{0.0, 0.0, 0.0}}};
  const SpatialGrid grid(places, 1.0);
  EXPECT_THAT(visitedNear(grid, {0.2, 0.3}), testing::ElementsAre(1u));
  EXPECT_THAT(visitedNear(grid, {1e15, -1e15}), testing::ElementsAre(0u));
}

}  // namespace
}  // namespace headway::objects
