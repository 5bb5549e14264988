// SPDX-License-Identifier: BSD-3-Clause
// Laws of the layouts of hall, campus and warehouse, over many seeds, without drawing.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "navigation_grid.h"
#include "robot.h"
#include "route.h"
#include "site.h"
#include "site_furniture.h"

namespace headway::sim {
namespace {

constexpr double kPerson = 0.28;  // half a person's width [m]

enum class Place { kHall, kCampus, kWarehouse };

Site siteOf(Place place, std::uint64_t seed) {
  static const Grain grain(1);
  switch (place) {
    case Place::kCampus:
      return makeCampus({}, grain, seed);
    case Place::kWarehouse:
      return makeWarehouse({}, grain, seed);
    case Place::kHall:
      break;
  }
  return makeHall({}, grain, seed);
}

/// Boxes of a material, by where the corners of their triangles are [cm].
std::multiset<std::array<long, 9>> trianglesOf(const Site& site, Material material) {
  std::multiset<std::array<long, 9>> all;
  const auto found = site.surfaces.find(material);
  if (found == site.surfaces.end()) return all;
  for (const auto& triangle : found->second.triangles) {
    std::array<long, 9> at{};
    for (std::size_t i = 0; i < 9; ++i) {
      at[i] = std::lround(100.0F * triangle[i / 3].position[static_cast<int>(i % 3)]);
    }
    all.insert(at);
  }
  return all;
}

TEST(MovedFurnitureTest, AsMuchOfTheLoadsAsIsAskedForIsExchanged) {
  static const Grain grain(1);
  WorldParams params;
  const Site before = makeWarehouse(params, grain, 3);
  params.moved_ratio = 0.4;
  const Site after = makeWarehouse(params, grain, 3);
  const auto cartons = trianglesOf(before, Material::kCardboard);
  int stayed = 0;
  const auto now = trianglesOf(after, Material::kCardboard);
  for (const auto& triangle : cartons) stayed += now.count(triangle) > 0 ? 1 : 0;
  EXPECT_NEAR(0.6, stayed / static_cast<double>(cartons.size()), 0.15);
  EXPECT_EQ(trianglesOf(before, Material::kOrangeSteel), trianglesOf(after, Material::kOrangeSteel))
      << "racks stay";
}

TEST(IdenticalRacksTest, EachBayHasTheLoadsOfTheFirst) {
  static const Grain grain(1);
  WorldParams params;
  params.identical_racks = true;
  const auto cartons = trianglesOf(makeWarehouse(params, grain, 3), Material::kCardboard);
  int shown_again = 0;
  for (auto triangle : cartons) {
    for (const std::size_t x : {0, 3, 6}) triangle[x] += std::lround(100.0 * kRackBay.length);
    shown_again += cartons.count(triangle) > 0 ? 1 : 0;
  }
  EXPECT_GT(shown_again, static_cast<int>(cartons.size()) * 2 / 3) << "in the next bay";
}

Eigen::AlignedBox2d boundsOf(const Drop& drop) {
  Eigen::AlignedBox2d bounds;
  for (const auto& corner : drop.outline) bounds.extend(corner);
  return bounds;
}

/// A point in the axes of a footprint, from its middle [m].
Eigen::Vector2d within(const Footprint& footprint, const Eigen::Vector2d& at) {
  const Eigen::Vector2d ex(std::cos(footprint.yaw), std::sin(footprint.yaw));
  const Eigen::Vector2d to = at - footprint.centre;
  return {to.dot(ex), ex.x() * to.y() - ex.y() * to.x()};
}

double distanceTo(const Footprint& footprint, const Eigen::Vector2d& at) {
  const Eigen::Vector2d beyond = within(footprint, at).cwiseAbs() - 0.5 * footprint.size;
  return beyond.cwiseMax(0.0).norm();
}

double lowestOf(const Mesh& mesh) {
  float lowest = 1e9F;
  for (const auto& triangle : mesh.triangles) {
    for (const auto& vertex : triangle) lowest = std::min(lowest, vertex.position.z());
  }
  return lowest;
}

class SiteLayoutTest : public ::testing::TestWithParam<Place> {
 protected:
  static constexpr std::uint64_t kSeeds = 8;
};

TEST_P(SiteLayoutTest, TheRobotReachesEveryStopFromItsStart) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Site site = siteOf(GetParam(), seed);
    const NavigationGrid grid(site);
    ASSERT_GE(site.robot_stops.size(), 8U);
    for (const auto& stop : site.robot_stops) {
      EXPECT_TRUE(site.area.contains(stop));
      EXPECT_GE(grid.clearance(stop), WheeledRobot::kRadius) << seed << ": " << stop.transpose();
      const bool is_start = (stop - site.robot_stops.front()).norm() < 0.2;
      EXPECT_TRUE(is_start ||
                  !grid.path(site.robot_stops.front(), stop, WheeledRobot::kRadius).empty())
          << seed << ": " << stop.transpose();
    }
  }
}

TEST_P(SiteLayoutTest, PeopleReachEveryDestination) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Site site = siteOf(GetParam(), seed);
    const NavigationGrid grid(site);
    ASSERT_GE(site.destinations.size(), 5U);
    int reached = 0;
    for (const auto& place : site.destinations) {
      EXPECT_TRUE(site.area.contains(place));
      reached += grid.path(site.robot_stops.front(), place, kPerson).empty() ? 0 : 1;
    }
    // Furniture placed at random may cover some destinations; people then choose another.
    EXPECT_GE(reached, 0.85 * static_cast<double>(site.destinations.size())) << seed;
  }
}

TEST_P(SiteLayoutTest, AWayFromStopToStopKeepsItsDistanceFromFurniture) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Site site = siteOf(GetParam(), seed);
    const NavigationGrid grid(site);
    for (std::size_t i = 1; i < site.robot_stops.size(); i += 3) {
      Eigen::Vector2d at = site.robot_stops.front();
      for (const auto& corner : grid.path(at, site.robot_stops[i], WheeledRobot::kRadius)) {
        for (double t = 0.0; t <= 1.0; t += 0.1) {
          const Eigen::Vector2d here = at + t * (corner - at);
          for (const Footprint& obstacle : site.obstacles) {
            EXPECT_GT(distanceTo(obstacle, here), 0.15) << seed << ": " << here.transpose();
          }
        }
        at = corner;
      }
    }
  }
}

TEST_P(SiteLayoutTest, DropsAreConvexCounterclockwiseAndDeeperThanAStep) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Site site = siteOf(GetParam(), seed);
    ASSERT_FALSE(site.drops.empty());
    const NavigationGrid grid(site);
    for (const Drop& drop : site.drops) {
      EXPECT_GT(drop.depth_m, 1.0);
      ASSERT_GE(drop.outline.size(), 3U);
      const std::size_t n = drop.outline.size();
      for (std::size_t i = 0; i < n; ++i) {
        const Eigen::Vector2d a = drop.outline[(i + 1) % n] - drop.outline[i];
        const Eigen::Vector2d b = drop.outline[(i + 2) % n] - drop.outline[(i + 1) % n];
        EXPECT_GT(a.x() * b.y() - a.y() * b.x(), 0.0) << "turns left at every corner";
      }
      EXPECT_TRUE(site.area.contains(boundsOf(drop)));
      EXPECT_EQ(grid.clearance(boundsOf(drop).center()), 0.0) << "closed to walkers";
    }
  }
}

TEST_P(SiteLayoutTest, NothingIsLowerThanTheFloorButDropsAndRoads) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Site site = siteOf(GetParam(), seed);
    double deepest = 0.0;
    for (const Drop& drop : site.drops) deepest = std::max(deepest, drop.depth_m);
    for (const auto& [material, mesh] : site.surfaces) {
      for (const auto& triangle : mesh.triangles) {
        for (const auto& vertex : triangle) {
          const Eigen::Vector2d at = vertex.position.head<2>().cast<double>();
          const auto in_drop = [&](const Drop& drop) {
            return boundsOf(drop).exteriorDistance(at) < 0.2;
          };
          if (std::any_of(site.drops.begin(), site.drops.end(), in_drop)) {
            EXPECT_GE(vertex.position.z(), -deepest - 1e-3);
          } else {
            EXPECT_GE(vertex.position.z(), -0.1 - 1e-3) << at.transpose();
          }
        }
      }
    }
    EXPECT_NEAR(lowestOf(site.surfaces.at(GetParam() == Place::kWarehouse ? Material::kAsphalt
                                                                          : Material::kConcrete)),
                -deepest, 1e-4);
  }
}

TEST_P(SiteLayoutTest, SpotsAndStopsLieBesideDrops) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Site site = siteOf(GetParam(), seed);
    for (const Drop& drop : site.drops) {
      for (const Spot& spot : site.spots) {
        EXPECT_GT(boundsOf(drop).exteriorDistance(spot.position), 0.3) << seed;
      }
      double nearest = 1e9;
      for (const auto& stop : site.robot_stops) {
        nearest = std::min(nearest, boundsOf(drop).exteriorDistance(stop));
        EXPECT_GT(boundsOf(drop).exteriorDistance(stop), WheeledRobot::kRadius) << seed;
      }
      EXPECT_LT(nearest, 4.0) << "the robot comes by";
    }
  }
}

TEST_P(SiteLayoutTest, NoTwoIdlePeopleShareAPlace) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Site site = siteOf(GetParam(), seed);
    ASSERT_FALSE(site.spots.empty());
    for (std::size_t i = 0; i < site.spots.size(); ++i) {
      for (std::size_t k = i + 1; k < site.spots.size(); ++k) {
        EXPECT_GT((site.spots[i].position - site.spots[k].position).norm(), 0.3) << seed;
      }
    }
  }
}

TEST_P(SiteLayoutTest, WhoStandsAboutStandsInNothing) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Site site = siteOf(GetParam(), seed);
    for (const Spot& spot : site.spots) {
      if (spot.seat) continue;
      EXPECT_TRUE(site.area.contains(spot.position));
      for (const Footprint& obstacle : site.obstacles) {
        EXPECT_GT(distanceTo(obstacle, spot.position), 0.1)
            << seed << ": " << spot.position.transpose();
      }
    }
  }
}

TEST_P(SiteLayoutTest, LoopsOfVehiclesAreFreeAndCloseSmoothly) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Site site = siteOf(GetParam(), seed);
    EXPECT_EQ(site.loops.empty(), GetParam() == Place::kHall);
    for (const VehicleLoop& loop : site.loops) {
      Random random(1);
      const double half_width = 0.5 * drawSize(loop.kind, random).y();
      const Path path(loop.points, true);
      EXPECT_GT(path.length(), 30.0);
      for (double s = 0.0; s < path.length(); s += 0.5) {
        const Eigen::Vector2d at = path.at(s).position.head<2>();
        EXPECT_TRUE(site.area.contains(at));
        for (const Footprint& obstacle : site.obstacles) {
          EXPECT_GT(distanceTo(obstacle, at), half_width) << seed << ": " << at.transpose();
        }
        EXPECT_LT(std::abs(path.curvature(s)), 3.0) << "no hairpins within a sample";
      }
    }
  }
}

TEST_P(SiteLayoutTest, TheSameSeedGivesTheSamePlaceAndAnotherAnother) {
  const Site one = siteOf(GetParam(), 5), same = siteOf(GetParam(), 5),
             other = siteOf(GetParam(), 6);
  ASSERT_EQ(one.obstacles.size(), same.obstacles.size());
  for (std::size_t i = 0; i < one.obstacles.size(); ++i) {
    EXPECT_EQ(one.obstacles[i].centre, same.obstacles[i].centre);
  }
  ASSERT_EQ(one.surfaces.size(), same.surfaces.size());
  for (const auto& [material, mesh] : one.surfaces) {
    const Mesh& again = same.surfaces.at(material);
    ASSERT_EQ(mesh.triangles.size(), again.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      EXPECT_EQ(mesh.triangles[i][0].position, again.triangles[i][0].position);
    }
  }
  bool differs = one.obstacles.size() != other.obstacles.size();
  for (std::size_t i = 0; !differs && i < one.obstacles.size(); ++i) {
    differs = one.obstacles[i].centre != other.obstacles[i].centre;
  }
  EXPECT_TRUE(differs);
}

INSTANTIATE_TEST_SUITE_P(All, SiteLayoutTest,
                         ::testing::Values(Place::kHall, Place::kCampus, Place::kWarehouse));

/// Whether a wall with the corridor's height stands at a place.
bool isBlocked(const Site& site, const Eigen::Vector2d& at) {
  return std::any_of(site.obstacles.begin(), site.obstacles.end(),
                     [&](const Footprint& obstacle) { return distanceTo(obstacle, at) == 0.0; });
}

TEST(HallLayoutTest, DoorsAreWideEnoughForTheRobotAndHaveTheirThresholds) {
  int thresholds = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Site site = siteOf(Place::kHall, seed);
    for (const Threshold& threshold : site.thresholds) {
      ++thresholds;
      EXPECT_GE(threshold.height_m, 0.005);
      EXPECT_LE(threshold.height_m, 0.015);
      const double half = 0.5 * threshold.strip.size.y();
      EXPECT_GE(2.0 * half, 0.9);
      // Free over its whole length, with a wall at either end.
      for (double x = -half; x <= half; x += 0.05) {
        EXPECT_FALSE(isBlocked(site, threshold.strip.centre + Eigen::Vector2d(x, 0.0))) << seed;
      }
      for (const double x : {half + 0.15, -half - 0.15}) {
        EXPECT_TRUE(isBlocked(site, threshold.strip.centre + Eigen::Vector2d(x, 0.0))) << seed;
      }
    }
  }
  EXPECT_GT(thresholds, 12 * 4);
}

TEST(HallLayoutTest, EveryRoomIsLeftByItsDoorAlone) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Site site = siteOf(Place::kHall, seed);
    const Eigen::Vector2d corridor = site.robot_stops.front();
    std::vector<Eigen::Vector2d> rooms;
    for (const auto& stop : site.robot_stops) {
      if (std::abs(stop.y() - corridor.y()) > 2.0 && stop.x() > 0.0) rooms.push_back(stop);
    }
    ASSERT_GE(rooms.size(), 6U);
    for (const auto& room : rooms) {  // 1.1 m behind its door
      const double door_y = room.y() + (room.y() > corridor.y() ? -1.1 : 1.1);
      Site closed = site;
      closed.obstacles.push_back({{room.x(), door_y}, {1.4, 0.2}, 0.0});
      const NavigationGrid grid(closed);
      EXPECT_TRUE(grid.path(room, corridor, 0.2).empty()) << seed << ": " << room.transpose();
    }
  }
}

TEST(HallLayoutTest, WallsReachTheCeilingAndNothingStandsAboveIt) {
  const Site site = siteOf(Place::kHall, 2);
  for (const auto& [material, mesh] : site.surfaces) {
    for (const auto& triangle : mesh.triangles) {
      for (const auto& vertex : triangle) EXPECT_LE(vertex.position.z(), 2.8F + 1e-4F);
    }
  }
  EXPECT_NEAR(lowestOf(site.surfaces.at(Material::kCeiling)), 2.8, 1e-5);
}

TEST(CampusLayoutTest, ARailingKeepsPeopleFromTheStairsOnThreeSides) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Site site = siteOf(Place::kCampus, seed);
    ASSERT_EQ(site.drops.size(), 1U);
    const Eigen::AlignedBox2d stairs = boundsOf(site.drops[0]);
    const Eigen::Vector2d middle = stairs.center(), half = 0.5 * stairs.sizes();
    EXPECT_TRUE(isBlocked(site, {middle.x(), middle.y() + half.y()}));
    EXPECT_TRUE(isBlocked(site, {middle.x(), middle.y() - half.y()}));
    EXPECT_TRUE(isBlocked(site, {middle.x() + half.x(), middle.y()}));
    EXPECT_FALSE(isBlocked(site, {middle.x() - half.x() - 0.1, middle.y()})) << "open at the top";
  }
}

TEST(CampusLayoutTest, BicyclesStandWherePeopleDoNotWalk) {
  int bicycles = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Site site = siteOf(Place::kCampus, seed);
    for (const Spot& bicycle : site.bicycles) {
      EXPECT_TRUE(isBlocked(site, bicycle.position)) << seed;
      ++bicycles;
    }
  }
  EXPECT_GT(bicycles, 10);
}

TEST(WarehouseLayoutTest, AislesAreWideEnoughForAForklift) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Site site = siteOf(Place::kWarehouse, seed);
    const NavigationGrid grid(site);
    Random random(1);
    const double forklift = drawSize(ActorKind::kForklift, random).y();
    ASSERT_EQ(site.loops.size(), 1U);
    for (const auto& point : site.loops[0].points) {
      EXPECT_GT(grid.clearance(point.head<2>()), 0.5 * forklift) << point.transpose();
    }
    EXPECT_EQ(site.drops.size(), 2U) << "two docks";
    EXPECT_EQ(site.thresholds.size(), 2U);
  }
}

}  // namespace
}  // namespace headway::sim
