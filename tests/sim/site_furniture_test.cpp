// SPDX-License-Identifier: BSD-3-Clause
// Laws of furniture: its size, what it blocks, who may sit on it.
#include "site_furniture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "actor_mesh.h"

namespace headway::sim {
namespace {

Eigen::AlignedBox3d extentOf(const Site& site) {
  Eigen::AlignedBox3d box;
  for (const auto& [material, mesh] : site.surfaces) {
    for (const auto& triangle : mesh.triangles) {
      for (const auto& vertex : triangle) box.extend(vertex.position.cast<double>());
    }
  }
  for (const auto& triangle : site.furniture.triangles) {
    for (const auto& vertex : triangle) box.extend(vertex.position.cast<double>());
  }
  return box;
}

/// A piece of furniture and what its description promises.
struct Piece {
  std::string name;
  std::function<void(SiteBuilder&, const Spot&, Random&)> add;
  Eigen::Vector2d largest;  ///< along x and y, when it stands at the origin [m]
  double lowest, highest;   ///< of its top [m]
  std::size_t seats;
  bool blocks;
};

const std::vector<Piece>& pieces() {
  static const std::vector<Piece> kPieces = {
      {"desk", addDesk, {2.0, 2.0}, 0.74, 1.3, 1, true},
      {"chair", addChair, {0.8, 0.7}, 0.9, 1.1, 1, true},
      {"sofa",
       [](auto& b, const Spot& at, Random&) { addSofa(b, at); },
       {1.0, 2.0},
       0.8,
       0.9,
       2,
       true},
      {"cupboard", addCupboard, {0.5, 1.05}, 1.6, 2.1, 0, true},
      {"bench",
       [](auto& b, const Spot& at, Random&) { addBench(b, at); },
       {0.7, 1.85},
       0.7,
       0.85,
       2,
       true},
      {"radiator",
       [](auto& b, const Spot& at, Random&) { addRadiator(b, at); },
       {0.2, 1.25},
       0.6,
       0.75,
       0,
       true},
      {"notice", addNotice, {0.05, 0.95}, 1.4, 2.4, 0, false},
      {"socket",
       [](auto& b, const Spot& at, Random&) { addSocket(b, at); },
       {0.05, 0.2},
       1.0,
       1.2,
       0,
       false},
      {"pallet",
       [](auto& b, const Spot& at, Random& r) { addPallet(b, at, 0.0, r); },
       {1.25, 0.9},
       0.12,
       1.4,
       0,
       true},
      {"machine", addMachine, {1.3, 1.3}, 0.65, 2.4, 0, true},
      {"rack", addRackBay, {2.9, 1.3}, 4.3, 4.6, 0, true},
  };
  return kPieces;
}

class FurnitureTest : public ::testing::TestWithParam<std::size_t> {
 protected:
  const Piece& piece = pieces()[GetParam()];
};

TEST_P(FurnitureTest, HasItsSizeAndStandsOnTheFloor) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Site site;
    SiteBuilder builder(site);
    Random random(seed);
    piece.add(builder, {{0, 0}, 0.0}, random);
    const Eigen::AlignedBox3d box = extentOf(site);
    EXPECT_LE(box.sizes().x(), piece.largest.x()) << piece.name;
    EXPECT_LE(box.sizes().y(), piece.largest.y()) << piece.name;
    EXPECT_GE(box.max().z(), piece.lowest) << piece.name;
    EXPECT_LE(box.max().z(), piece.highest) << piece.name;
    EXPECT_GE(box.min().z(), -1e-6) << piece.name;
  }
}

TEST_P(FurnitureTest, BlocksWhereItStandsAndOffersItsSeats) {
  Site site;
  SiteBuilder builder(site);
  Random random(3);
  piece.add(builder, {{5, 7}, 0.6}, random);
  EXPECT_EQ(site.spots.size(), piece.seats) << piece.name;
  for (const Spot& spot : site.spots) {
    EXPECT_TRUE(spot.seat);
    EXPECT_LT((spot.position - Eigen::Vector2d(5, 7)).norm(), 1.5);
  }
  EXPECT_EQ(!site.obstacles.empty(), piece.blocks) << piece.name;
  const Eigen::AlignedBox3d box = extentOf(site);
  for (const Footprint& obstacle : site.obstacles) {
    EXPECT_TRUE(
        Eigen::AlignedBox2d(box.min().head<2>(), box.max().head<2>()).contains(obstacle.centre))
        << piece.name;
  }
}

TEST_P(FurnitureTest, TurnsWithItsPlace) {
  const auto extentAt = [&](double yaw) {
    Site site;
    SiteBuilder builder(site);
    Random random(4);
    piece.add(builder, {{0, 0}, yaw}, random);
    return extentOf(site);
  };
  const Eigen::AlignedBox3d straight = extentAt(0.0), turned = extentAt(M_PI / 2);
  EXPECT_NEAR(straight.sizes().x(), turned.sizes().y(), 0.02) << piece.name;
  EXPECT_NEAR(straight.sizes().y(), turned.sizes().x(), 0.02) << piece.name;
  EXPECT_NEAR(straight.max().x(), turned.max().y(), 0.02) << piece.name << ": x becomes y";
}

INSTANTIATE_TEST_SUITE_P(All, FurnitureTest, ::testing::Range<std::size_t>(0, 10),
                         [](const auto& param) { return pieces()[param.param].name; });

TEST(FurnitureGroupTest, AMeetingTableHasChairsOnBothSidesThatFaceIt) {
  Site site;
  SiteBuilder builder(site);
  Random random(2);
  addMeetingTable(builder, {{0, 0}, 0.0}, 4, random);
  EXPECT_GE(site.spots.size(), 5U);
  EXPECT_LE(site.spots.size(), 8U);
  int left = 0;
  for (const Spot& spot : site.spots) {
    left += spot.position.y() > 0.0 ? 1 : 0;
    EXPECT_GT(-std::sin(spot.yaw) * spot.position.y(), 0.0) << "towards the table";
  }
  EXPECT_GT(left, 1);
  EXPECT_LT(left, static_cast<int>(site.spots.size()) - 1);
}

TEST(FurnitureGroupTest, ABicycleStandBlocksAndHoldsBicyclesAcrossItsRow) {
  Site site;
  SiteBuilder builder(site);
  Random random(2);
  addBicycleStand(builder, {{10, 0}, 0.0}, 6, random);
  ASSERT_EQ(site.obstacles.size(), 1U);
  EXPECT_EQ(site.obstacles[0].size, Eigen::Vector2d(4.5, 1.9));
  EXPECT_GE(site.bicycles.size(), 3U);
  EXPECT_LE(site.bicycles.size(), 6U);
  for (const Spot& bicycle : site.bicycles) {
    EXPECT_NEAR(std::abs(std::sin(bicycle.yaw)), 1.0, 0.05);
    EXPECT_LT(std::abs(bicycle.position.x() - 10.0), 2.25);
  }
}

TEST(FurnitureGroupTest, APalletStandsOnWhatItIsPutOn) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Site site;
    SiteBuilder builder(site);
    Random random(seed);
    addPallet(builder, {{0, 0}, 0.0}, 3.0, random);
    EXPECT_NEAR(extentOf(site).min().z(), 3.0, 1e-6);
    EXPECT_TRUE(site.obstacles.empty()) << "above heads";
  }
}

TEST(MachineMeshTest, FillsTheActorsSizeAndStandsOnTheGround) {
  Random random(1);
  for (const ActorKind kind : {ActorKind::kForklift, ActorKind::kDeliveryRobot, ActorKind::kBicycle,
                               ActorKind::kSeatedPerson, ActorKind::kCyclist}) {
    Actor actor;
    actor.kind = kind;
    actor.size = drawSize(kind, random);
    Eigen::AlignedBox3d box;
    const Mesh mesh = actorMesh(actor, Eigen::Vector3d::Zero());
    for (const auto& corner : boxCorners(mesh)) box.extend(corner.cast<double>());
    const int number = static_cast<int>(kind);
    EXPECT_NEAR(box.min().z(), 0.0, 0.08) << number;
    EXPECT_LT(box.sizes().x(), 1.25 * actor.size.x()) << number;
    EXPECT_GT(box.sizes().x(), 0.75 * actor.size.x()) << number;
    EXPECT_LT(box.sizes().y(), 1.3 * actor.size.y()) << number;
    EXPECT_GT(box.sizes().z(), 0.85 * actor.size.z()) << number;
  }
}

TEST(MachineMeshTest, AForkliftLiesWithinItsPartsAndFillsThem) {
  Random random(1);
  Actor actor;
  actor.kind = ActorKind::kForklift;
  actor.size = drawSize(actor.kind, random);
  const auto parts = partsOf(actor.kind, {actor.position.head<2>(), actor.size.head<2>(), 0.0});
  std::vector<Eigen::AlignedBox2d> filled(parts.size());
  const Mesh mesh = forkliftMesh(actor);
  for (const auto& triangle : mesh.triangles) {
    for (const auto& vertex : triangle) {
      const Eigen::Vector2d place = vertex.position.head<2>().cast<double>();
      bool is_inside = false;
      for (std::size_t i = 0; i < parts.size(); ++i) {
        const Eigen::Vector2d offset = (place - parts[i].centre).cwiseAbs();
        if ((offset - 0.5 * parts[i].size).maxCoeff() > 0.001) continue;
        filled[i].extend(place);
        is_inside = true;
      }
      EXPECT_TRUE(is_inside) << place.transpose();
    }
  }
  ASSERT_EQ(2u, parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    EXPECT_NEAR(filled[i].sizes().y(), parts[i].size.y(), 0.01) << i;
    EXPECT_NEAR(filled[i].max().x(), parts[i].centre.x() + 0.5 * parts[i].size.x(), 0.01) << i;
  }
}

TEST(MachinesTest, StandClearOfWherePeopleAndTheRobotGo) {
  Site site;
  site.area = rectangle(0, 0, 12, 8);
  site.destinations = {{1, 1}};
  site.robot_stops = {{6, 4}};
  SiteBuilder builder(site);
  Random random(2);
  addMachines(builder, 12, random);
  EXPECT_GE(site.obstacles.size(), 12u);
  for (const Footprint& machine : site.obstacles) {
    EXPECT_GT((machine.centre - site.destinations[0]).norm(), 0.8);
    EXPECT_GT((machine.centre - site.robot_stops[0]).norm(), 0.8);
    EXPECT_TRUE(site.area.contains(machine.centre));
  }
}

}  // namespace
}  // namespace headway::sim
