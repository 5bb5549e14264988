// SPDX-License-Identifier: BSD-3-Clause
// Only fronts of closed meshes are drawn: whoever looks at one from outside must meet a front
// first.
#include <gtest/gtest.h>
#include <headway/core/random.h>

#include <string>

#include "actor_mesh.h"
#include "furniture.h"
#include "house.h"
#include "ray.h"

namespace headway::sim {
namespace {

/// Ratio of rays from around that meet the mesh at a front first, of those that meet it at all.
double frontRatio(const Mesh& mesh, std::uint64_t seed) {
  Eigen::AlignedBox3d box;
  for (const auto& triangle : mesh.triangles) {
    for (const auto& vertex : triangle) box.extend(vertex.position.cast<double>());
  }
  Random random(seed);
  const auto inside = [&](double grow) {
    const Eigen::Vector3d share(random.uniform(-grow, grow), random.uniform(-grow, grow),
                                random.uniform(-grow, grow));
    return Eigen::Vector3d(box.center() + 0.5 * box.sizes().cwiseProduct(share));
  };
  int fronts = 0, met = 0;
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector3d target = inside(0.9);
    const Eigen::Vector3d outwards = (inside(1.0) - box.center()).normalized();
    test::Ray ray{target + 2.0 * box.sizes().norm() * outwards, -outwards};
    double nearest = 1e9;
    bool front = false;
    for (const auto& triangle : mesh.triangles) {
      const std::array<Eigen::Vector3d, 3> corners = {triangle[0].position.cast<double>(),
                                                      triangle[1].position.cast<double>(),
                                                      triangle[2].position.cast<double>()};
      const auto at = test::meet(ray, corners);
      if (!at || *at >= nearest) continue;
      nearest = *at;
      front = (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(ray.way) > 0.0;
    }
    if (nearest == 1e9) continue;
    ++met;
    fronts += front ? 1 : 0;
  }
  EXPECT_GT(met, 40);
  return static_cast<double>(fronts) / met;
}

TEST(ClosedMeshesTest, VehiclesOfAllKinds) {
  for (const ActorKind kind :
       {ActorKind::kCar, ActorKind::kVan, ActorKind::kTruck, ActorKind::kBus}) {
    for (int look = 0; look < 3; ++look) {
      Actor actor;
      actor.kind = kind;
      actor.look = look;
      actor.size = {4.5, 1.8, 1.6};
      EXPECT_GT(frontRatio(vehicleMesh(actor), 1), 0.995) << static_cast<int>(kind) << ' ' << look;
    }
  }
}

TEST(ClosedMeshesTest, HousesWithFlatAndWithPitchedRoofs) {
  for (const double ridge : {0.0, 2.5}) {
    HousePlan plan;
    plan.ridge_m = ridge;
    // A house is never seen from below.
    Mesh house = houseMesh(plan, Eigen::Vector3f(3, -2, 0), 0.4F);
    const Block block = houseBlock(plan, Eigen::Vector3f(3, -2, 0), 0.4F);
    house.addQuad(block[0], block[1], block[2], block[3], UvRect{});
    EXPECT_EQ(1.0, frontRatio(house, 2)) << ridge;
  }
}

TEST(ClosedMeshesTest, TreesLampsThingsAndHedges) {
  for (std::uint64_t seed = 1; seed < 9; ++seed) {
    Random random(seed);
    Mesh tree, lamp, thing, hedge;
    addTree(tree, Eigen::Vector3f::Zero(), random);
    addLamp(lamp, Eigen::Vector3f::Zero(), 0.3F, random);
    addSmallThing(thing, Eigen::Vector3f::Zero(), 0.3F, random);
    addHedge(hedge, Eigen::Vector3f::Zero(), Eigen::Vector3f(5, 1, 0), random);
    EXPECT_EQ(1.0, frontRatio(tree, seed));
    EXPECT_EQ(1.0, frontRatio(thing, seed));
    EXPECT_EQ(1.0, frontRatio(hedge, seed));
  }
}

TEST(ClosedMeshesTest, ATurnedOverMeshShowsItsBacks) {
  HousePlan plan;
  EXPECT_LT(frontRatio(turnedOver(houseMesh(plan, Eigen::Vector3f::Zero(), 0.0F)), 3), 0.5);
}

}  // namespace
}  // namespace headway::sim
