// SPDX-License-Identifier: BSD-3-Clause
// Laws of what is built along streets, without drawing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <set>

#include "house.h"
#include "route.h"
#include "street.h"
#include "textures.h"

namespace headway::sim {
namespace {

/// A straight street of 300 m with cross streets, its stretches and what stands along them.
struct Town {
  explicit Town(int seed = 1, double cross_every = 75.0, double hill = 0.0) {
    params.seed = seed;
    params.hill_height_m = hill;
    params.cross_street_every_m = cross_every;
    RouteParams route_params;
    route_params.shape = "straight 300";
    route = std::make_unique<Route>(makeRoute(route_params, hill));
    network = std::make_unique<RoadNetwork>(*route, cross_every, 9);
    builder = std::make_unique<StreetBuilder>(*network, params, grain);
  }
  [[nodiscard]] std::vector<StretchKey> keys(std::size_t road) const {
    std::vector<StretchKey> all;
    for (int i = 0; i * kStretch < network->roads()[road].axis.length() - 1.0; ++i) {
      if (builder->exists({road, i})) all.push_back({road, i});
    }
    return all;
  }

  WorldParams params;
  Grain grain{3};
  std::unique_ptr<Route> route;
  std::unique_ptr<RoadNetwork> network;
  std::unique_ptr<StreetBuilder> builder;
};

std::vector<Eigen::Vector3d> verticesOf(const Mesh& mesh, const Eigen::Vector3d& anchor) {
  std::vector<Eigen::Vector3d> points;
  for (const auto& triangle : mesh.triangles) {
    for (const auto& vertex : triangle) points.push_back(anchor + vertex.position.cast<double>());
  }
  return points;
}

TEST(StreetStretchTest, TheGroundIsCarriagewayKerbAndPavement) {
  const Town town(1, 0.0);
  for (const StretchKey& key : town.keys(0)) {
    const StreetStretch stretch = town.builder->build(key);
    ASSERT_FALSE(stretch.surfaces.empty());
    double lowest = 1e9, highest = -1e9;
    std::set<long> kerb_heights;
    for (const auto& at : verticesOf(stretch.surfaces[0].mesh, stretch.anchor)) {
      const double left = std::abs(at.y());
      lowest = std::min(lowest, at.z());
      highest = std::max(highest, at.z());
      EXPECT_LE(left, kStreet.edge + 1e-3);
      if (left < kStreet.carriageway - 1e-3) {
        EXPECT_NEAR(at.z(), 0.0, 1e-4);
      } else if (left > kStreet.carriageway + 1e-3) {
        EXPECT_NEAR(at.z(), kStreet.kerb_height, 1e-4);
      } else {
        kerb_heights.insert(std::lround(100.0 * at.z()));
      }
    }
    EXPECT_NEAR(lowest, 0.0, 1e-4);
    EXPECT_NEAR(highest, 0.12, 1e-4);
    EXPECT_EQ(kerb_heights, (std::set<long>{0, 12})) << "the kerb's face stands upright";
  }
}

TEST(StreetStretchTest, HousesAndFurnitureLeaveTheCarriagewayFree) {
  for (const int seed : {1, 2, 3}) {
    const Town town(seed);
    int houses = 0, items = 0;
    for (const StretchKey& key : town.keys(0)) {
      const StreetStretch stretch = town.builder->build(key);
      for (std::size_t i = 1; i < stretch.surfaces.size(); ++i, ++houses) {
        ASSERT_TRUE(stretch.surfaces[i].block) << "a house has a block that hides things";
        for (const Eigen::Vector3f& corner : *stretch.surfaces[i].block) {
          const Eigen::Vector3d at = stretch.anchor + corner.cast<double>();
          EXPECT_GT(std::abs(at.y()), kStreet.edge - 0.05) << seed;
        }
      }
      for (const Mesh& item : stretch.furniture) {
        ++items;
        for (const auto& at : verticesOf(item, stretch.anchor)) {
          if (at.z() > 1.7) continue;  // crowns and lamps reach over the street
          EXPECT_GT(std::abs(at.y()), kStreet.carriageway - 0.3) << seed << ": at " << at.z();
          EXPECT_GT(at.z(), -0.35);
        }
      }
    }
    EXPECT_GT(houses, 40);
    EXPECT_GT(items, 60);
  }
}

TEST(StreetStretchTest, NoHouseStandsInACrossStreet) {
  const Town town(2);
  ASSERT_GT(town.network->roads().size(), 2U);
  for (const StretchKey& key : town.keys(0)) {
    const StreetStretch stretch = town.builder->build(key);
    for (std::size_t i = 1; i < stretch.surfaces.size(); ++i) {
      for (const Eigen::Vector3f& corner : *stretch.surfaces[i].block) {
        const Eigen::Vector2d at = (stretch.anchor + corner.cast<double>()).head<2>();
        for (std::size_t road = 1; road < town.network->roads().size(); ++road) {
          const auto& cross = town.network->roads()[road];
          EXPECT_GT(std::abs(at.x() - cross.axis.at(0.0).position.x()), kStreet.carriageway);
        }
      }
    }
  }
}

TEST(StreetStretchTest, NothingIsBuiltWhereNothingIsAskedFor) {
  Town town(1, 0.0);
  town.params.house_ratio = town.params.parked_ratio = town.params.tree_every_m = 0.0;
  const StreetBuilder builder(*town.network, town.params, town.grain);
  for (const StretchKey& key : town.keys(0)) {
    const StreetStretch stretch = builder.build(key);
    EXPECT_EQ(stretch.surfaces.size(), 1U) << "ground alone";
    EXPECT_TRUE(builder.parked(key).empty());
    for (const Mesh& item : stretch.furniture) {
      float highest = 0.0F;
      for (const auto& at : verticesOf(item, stretch.anchor)) {
        highest = std::max(highest, static_cast<float>(at.z()));
      }
      EXPECT_LT(highest, 8.0F) << "lamps, signs and hedges";
    }
  }
}

TEST(StreetStretchTest, FencesStandAtThePavementsOuterEdgeAndChangeNothingElse) {
  Town town(3, 0.0);
  const StreetBuilder without(*town.network, town.params, town.grain);
  town.params.fence_ratio = 1.0;
  const StreetBuilder builder(*town.network, town.params, town.grain);
  std::size_t fences = 0;
  for (const StretchKey& key : town.keys(0)) {
    const StreetStretch stretch = builder.build(key), plain = without.build(key);
    ASSERT_EQ(plain.surfaces.size(), stretch.surfaces.size());
    for (std::size_t i = plain.furniture.size(); i < stretch.furniture.size(); ++i, ++fences) {
      for (const auto& at : verticesOf(stretch.furniture[i], stretch.anchor)) {
        EXPECT_NEAR(kStreet.edge, std::abs(at.y()), 0.2);
        EXPECT_LT(at.z(), 1.5);
        EXPECT_GT(at.z(), 0.0);
      }
    }
  }
  EXPECT_GT(fences, 8U);
}

TEST(StreetStretchTest, AStretchDependsOnSeedAndKeyAlone) {
  const Town town(4), again(4), other(5);
  const auto sizeOf = [](const StreetStretch& stretch) {
    std::size_t count = stretch.verges.triangles.size();
    for (const Surface& surface : stretch.surfaces) count += surface.mesh.triangles.size();
    for (const Mesh& item : stretch.furniture) count += item.triangles.size();
    return count;
  };
  const auto keys = town.keys(0);
  std::vector<StreetStretch> backwards;
  for (auto key = keys.rbegin(); key != keys.rend(); ++key)
    backwards.push_back(again.builder->build(*key));
  int different = 0;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const StreetStretch stretch = town.builder->build(keys[i]);
    const StreetStretch& same = backwards[keys.size() - 1 - i];
    ASSERT_EQ(sizeOf(stretch), sizeOf(same));
    EXPECT_EQ(cv::norm(stretch.surfaces[0].picture, same.surfaces[0].picture, cv::NORM_INF), 0.0);
    different += sizeOf(stretch) != sizeOf(other.builder->build(keys[i])) ? 1 : 0;
  }
  EXPECT_GT(different, static_cast<int>(keys.size()) / 2);
}

TEST(StreetStretchTest, ParkedVehiclesStandInTheirStripWithoutTouching) {
  Town town(1, 75.0);
  town.params.parked_ratio = 1.0;
  const StreetBuilder builder(*town.network, town.params, town.grain);
  std::vector<Actor> parked;
  std::set<std::int64_t> ids;
  for (const StretchKey& key : town.keys(0)) {
    for (const Actor& vehicle : builder.parked(key)) {
      parked.push_back(vehicle);
      EXPECT_TRUE(ids.insert(vehicle.id).second);
      EXPECT_TRUE(vehicle.parked);
      EXPECT_EQ(vehicle.speed, 0.0);
      const double left = vehicle.position.y();
      EXPECT_NEAR(std::abs(left), kStreet.parking, 0.2);
      EXPECT_LT(std::abs(left) + 0.5 * vehicle.size.y(), kStreet.carriageway + 0.15);
      EXPECT_GT(std::cos(vehicle.yaw) * -left, 0.9 * std::abs(left)) << "on the right of its way";
    }
  }
  EXPECT_GT(parked.size(), 50U);
  for (std::size_t i = 0; i < parked.size(); ++i) {
    for (std::size_t k = i + 1; k < parked.size(); ++k) {
      if (parked[i].position.y() * parked[k].position.y() < 0.0) continue;
      const double gap = std::abs(parked[i].position.x() - parked[k].position.x()) -
                         0.5 * (parked[i].size.x() + parked[k].size.x());
      EXPECT_GT(gap, -0.25);
    }
  }
}

TEST(StreetStretchTest, VergesBeginAtThePavementsEdgeAndLieALittleLower) {
  const Town town(1, 0.0);
  const StreetStretch stretch = town.builder->build(town.keys(0)[5]);
  ASSERT_FALSE(stretch.verges.triangles.empty());
  for (const auto& at : verticesOf(stretch.verges, stretch.anchor)) {
    EXPECT_GE(std::abs(at.y()), kStreet.edge - 1e-3);
    EXPECT_NEAR(at.z(), kStreet.kerb_height - 0.02, 1e-4);
  }
}

TEST(StreetStretchTest, GroundFollowsTheHill) {
  const Town town(1, 0.0, 5.0);
  double rise = 0.0;
  for (const StretchKey& key : town.keys(0)) {
    const StreetStretch stretch = town.builder->build(key);
    for (const auto& at : verticesOf(stretch.surfaces[0].mesh, stretch.anchor)) {
      const double s = town.route->start_s + at.x();
      const double street = town.route->street.at(s).position.z();
      EXPECT_GT(at.z(), street - 0.04);
      EXPECT_LT(at.z(), street + kStreet.kerb_height + 0.04);
      rise = std::max(rise, std::abs(street));
    }
  }
  EXPECT_GT(rise, 1.0);
}

TEST(WorldTest, WhatIsInViewComesNearestFirstAndOnlyAhead) {
  const Town town(1);
  World world(town.params, *town.route);
  ViewCone ahead;
  ahead.viewpoint = {100.0, 0.0};
  ahead.half_width = 0.6;
  const Eigen::Vector3d viewpoint(100.0, 0.0, 1.5);
  const auto visible = world.inView(viewpoint, ahead);
  ASSERT_GT(visible.size(), 4U);
  double before = 0.0;
  for (const StretchKey& key : visible) {
    const double distance = (world.stretch(key).anchor - viewpoint).norm();
    EXPECT_GE(distance, before - 1e-9);
    EXPECT_LT(distance, town.params.view_distance_m + 1.0);
    EXPECT_GT(world.stretch(key).anchor.x(), viewpoint.x() - kStretch);
    before = distance;
  }
  ViewCone all_around = ahead;
  all_around.half_width = M_PI;
  EXPECT_GT(world.inView(viewpoint, all_around).size(), visible.size());
}

TEST(WorldTest, WhatIsLeftFarBehindIsGivenUp) {
  const Town town(1);
  World world(town.params, *town.route);
  ViewCone all_around;
  (void)world.inView({0, 0, 1.5}, all_around);
  const std::size_t near_start = world.built().size();
  all_around.viewpoint = {300.0, 0.0};
  (void)world.inView({300, 0, 1.5}, all_around);
  EXPECT_LT(world.built().size(), 2 * near_start);
  for (const auto& [key, stretch] : world.built()) {
    EXPECT_LT((stretch.anchor - Eigen::Vector3d(300, 0, 0)).head<2>().norm(),
              town.params.view_distance_m + 60.0);
  }
}

TEST(WorldTest, ParkedVehiclesNearAPlaceAreTheSameWheneverAsked) {
  const Town town(1);
  World world(town.params, *town.route);
  const auto first = world.parkedNear({150, 0, 0}, 60.0);
  (void)world.parkedNear({300, 0, 0}, 60.0);
  const auto again = world.parkedNear({150, 0, 0}, 60.0);
  ASSERT_EQ(first.size(), again.size());
  ASSERT_GT(first.size(), 3U);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].id, again[i].id);
    EXPECT_EQ(first[i].position, again[i].position);
    EXPECT_LT((first[i].position - Eigen::Vector3d(150, 0, 0)).head<2>().norm(), 60.0);
  }
}

TEST(ViewConeTest, TouchesWhatReachesIntoIt) {
  ViewCone cone;
  cone.viewpoint = {1.0, 2.0};
  cone.heading = M_PI / 2;
  cone.half_width = M_PI / 6;
  EXPECT_TRUE(cone.touches({1.0, 12.0}, 0.1));
  EXPECT_FALSE(cone.touches({11.0, 2.0}, 0.1));
  EXPECT_FALSE(cone.touches({1.0, -8.0}, 0.1));
  EXPECT_TRUE(cone.touches({1.0, 1.0}, 1.5)) << "the viewpoint is inside the disc";
  // On the edge of the cone, 10 m away: a disc reaches in as far as its radius.
  const Eigen::Vector2d beside(1.0 + 10.0 * std::sin(M_PI / 6 + 0.1),
                               2.0 + 10.0 * std::cos(M_PI / 6 + 0.1));
  EXPECT_FALSE(cone.touches(beside, 0.9));
  EXPECT_TRUE(cone.touches(beside, 1.1));
}

TEST(PlainMeshTest, LiesBelowEveryStreetNearIt) {
  const Town town(1, 0.0, 5.0);
  const Mesh plain = plainMesh(*town.network, {6, 0}, {96.0, 0.0, 0.0});
  int near_street = 0;
  for (const auto& at : verticesOf(plain, {96.0, 0.0, 0.0})) {
    if (std::abs(at.y()) > 1.0 || at.x() < 0.0 || at.x() > 300.0) continue;
    ++near_street;
    const double street = town.route->street.at(town.route->start_s + at.x()).position.z();
    EXPECT_LT(at.z(), street - 0.3);
  }
  EXPECT_GT(near_street, 20);
}

TEST(GroundTextureTest, RunsFromTheLeftEdgeToTheRightOne) {
  EXPECT_LT(groundTextureV(kStreet.edge), groundTextureV(0.0));
  EXPECT_LT(groundTextureV(0.0), groundTextureV(-kStreet.edge));
  EXPECT_NEAR(groundTextureV(0.0), 0.5, 1e-3);
  EXPECT_GE(groundTextureV(kStreet.edge), 0.0F);
  EXPECT_LE(groundTextureV(-kStreet.edge), 1.0F);
  const Grain grain(1);
  GroundMarks plain, crossing;
  crossing.crossing = true;
  Random one(2), same(2), striped(2);
  const cv::Mat street = drawGround(plain, grain, one);
  EXPECT_EQ(street.size(), cv::Size(kGroundTexture, kGroundTexture));
  EXPECT_EQ(cv::norm(street, drawGround(plain, grain, same), cv::NORM_INF), 0.0);
  cv::Mat changed;
  cv::absdiff(street, drawGround(crossing, grain, striped), changed);
  EXPECT_GT(cv::sum(changed)[0], 1e5) << "a zebra crossing is painted";
}

TEST(FacadeTextureTest, PartsDoNotOverlap) {
  const std::vector<UvRect> parts = {facadeFront(), facadeGable(), facadeRoof()};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    EXPECT_LT(parts[i].u0, parts[i].u1);
    EXPECT_LT(parts[i].v0, parts[i].v1);
    EXPECT_GE(std::min(parts[i].u0, parts[i].v0), 0.0F);
    EXPECT_LE(std::max(parts[i].u1, parts[i].v1), 1.0F);
    for (std::size_t k = i + 1; k < parts.size(); ++k) {
      const float w = std::min(parts[i].u1, parts[k].u1) - std::max(parts[i].u0, parts[k].u0);
      const float h = std::min(parts[i].v1, parts[k].v1) - std::max(parts[i].v0, parts[k].v0);
      EXPECT_TRUE(w <= 0.0F || h <= 0.0F) << i << ' ' << k;
    }
  }
}

}  // namespace
}  // namespace headway::sim
