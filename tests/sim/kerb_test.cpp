// SPDX-License-Identifier: BSD-3-Clause
// Laws of lowered kerbs, and of robots and people on them.
#include <gtest/gtest.h>

#include <cmath>

#include "navigation_grid.h"
#include "ray.h"
#include "site.h"
#include "site_environment.h"

namespace headway::sim {
namespace {

/// A pavement north of y = 0 and a roadway south of it, with one ramp at x = 5.
Site siteWithKerb(const Kerb& kerb) {
  Site site;
  SiteBuilder builder(site);
  site.area = rectangle(0, -4, 10, 4);
  builder.slope({{0, 0, -kerb.height_m},
                 {10, 0, -kerb.height_m},
                 {10, -4 * kerb.pavement, -kerb.height_m},
                 {0, -4 * kerb.pavement, -kerb.height_m}},
                Material::kAsphalt);
  builder.floor(rectangle(0, 0, 10, 4 * kerb.pavement), 0.0, Material::kPaving, kerb.rampAreas());
  addKerb(builder, kerb);
  return site;
}

Kerb kerbAt(double pavement) { return {0.0, pavement, 0.1, 0.0, 10.0, {5.0}}; }

TEST(KerbTest, TheGroundFallsEvenlyAlongTheRampAndStepsElsewhere) {
  for (const double pavement : {1.0, -1.0}) {
    const Site site = siteWithKerb(kerbAt(pavement));
    for (const double ratio : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      const double y = pavement * ratio * Kerb::kRun;
      EXPECT_NEAR(groundHeight(site, {5.0, y}), -0.1 * (1.0 - ratio), 1e-9);
      EXPECT_NEAR(groundHeight(site, {5.0 + 0.95 * Kerb::kHalfRamp, y}), -0.1 * (1.0 - ratio),
                  1e-9);
    }
    for (const double x : {1.0, 3.5, 6.5, 9.0}) {
      EXPECT_EQ(groundHeight(site, {x, pavement * 0.01}), 0.0);
      EXPECT_NEAR(groundHeight(site, {x, -pavement * 0.01}), -0.1, 1e-9);
    }
  }
}

TEST(KerbTest, FlaresRiseToThePavementOnEitherSide) {
  const Site site = siteWithKerb(kerbAt(1.0));
  for (const double side : {1.0, -1.0}) {
    const double inner = 5.0 + side * Kerb::kHalfRamp;
    EXPECT_NEAR(groundHeight(site, {inner + side * 0.5 * Kerb::kFlare, 1e-4}), -0.05, 1e-3);
    EXPECT_NEAR(groundHeight(site, {inner + side * 0.99 * Kerb::kFlare, 1e-4}), -0.001, 1e-3);
    EXPECT_EQ(groundHeight(site, {inner + side * 0.8 * Kerb::kFlare, 0.8 * Kerb::kRun}), 0.0);
  }
}

TEST(KerbTest, TheGroundHasNoStepsButAtTheKerb) {
  const Site site = siteWithKerb(kerbAt(1.0));
  constexpr double kStep = 0.02;
  for (double x = 0.5; x < 9.5; x += kStep) {
    for (double y = 0.01; y < 2.0; y += kStep) {
      const double here = groundHeight(site, {x, y});
      EXPECT_LT(std::abs(groundHeight(site, {x, y + kStep}) - here), 0.1 * kStep) << x << ' ' << y;
      EXPECT_LT(std::abs(groundHeight(site, {x + kStep, y}) - here), 0.3 * kStep) << x << ' ' << y;
    }
  }
}

TEST(KerbTest, WhatIsDrawnIsWhereTheGroundIs) {
  const Site site = siteWithKerb(kerbAt(-1.0));
  double area = 0.0;
  for (const auto& triangle : site.surfaces.at(Material::kConcrete).triangles) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto& vertex : triangle) middle += vertex.position.cast<double>() / 3.0;
    EXPECT_NEAR(groundHeight(site, middle.head<2>()), middle.z(), 1e-6);
    const Eigen::Vector3f up = (triangle[1].position - triangle[0].position)
                                   .cross(triangle[2].position - triangle[0].position);
    EXPECT_LT(up.z(), 0.0F) << "clockwise from above";
    area -= 0.5 * up.z();
  }
  EXPECT_NEAR(area, 2.0 * (Kerb::kHalfRamp + Kerb::kFlare) * Kerb::kRun, 1e-5) << "no hole is left";
}

TEST(KerbTest, StonesStandACentimetreAboveThePavementBesideTheRamp) {
  const Site site = siteWithKerb(kerbAt(1.0));
  double length = 0.0;
  for (const auto& triangle : site.surfaces.at(Material::kSteel).triangles) {
    Eigen::AlignedBox3f box;
    for (const auto& vertex : triangle) box.extend(vertex.position);
    EXPECT_GE(box.min().z(), -0.1F - 1e-6F);
    EXPECT_LE(box.max().z(), 0.01F + 1e-6F);
    EXPECT_FALSE(box.min().x() < 5.0F && box.max().x() > 5.0F) << "none crosses the ramp";
    EXPECT_LE(box.max().y(), 1e-6F) << "they belong to the roadway";
    if (box.sizes().z() == 0.0F) length += 0.5 * box.sizes().x();
  }
  EXPECT_NEAR(length, 10.0 - 2.0 * (Kerb::kHalfRamp + Kerb::kFlare), 0.15) << "and joints";
}

TEST(KerbTest, NoGapIsLeftBetweenRoadwayAndFlares) {
  for (const double pavement : {1.0, -1.0}) {
    const Site site = siteWithKerb(kerbAt(pavement));
    for (double x = 5.0 - Kerb::kHalfRamp - Kerb::kFlare + 0.02; x < 7.0; x += 0.05) {
      const double top = groundHeight(site, {x, pavement * 1e-6});
      if (std::abs(x - 5.0) < Kerb::kHalfRamp || top > -0.01) continue;
      const test::Ray level{{x, -1.0 * pavement, -0.1 + 0.5 * (top + 0.1)}, {0, pavement, 0}};
      int met = 0;
      for (const auto& t : site.surfaces.at(Material::kSteel).triangles) {
        met += test::meet(level, {t[0].position.cast<double>(), t[1].position.cast<double>(),
                                  t[2].position.cast<double>()})
                   ? 1
                   : 0;
      }
      EXPECT_GT(met, 0) << x;
    }
  }
}

TEST(KerbTest, IsCrossedAtTheRampAlone) {
  const Site site = siteWithKerb(kerbAt(1.0));
  const NavigationGrid grid(site);
  const auto way = grid.path({1.0, 2.5}, {1.0, -2.5}, 0.32);
  ASSERT_FALSE(way.empty());
  Eigen::Vector2d at(1.0, 2.5);
  for (const Eigen::Vector2d& corner : way) {
    for (double t = 0.0; t <= 1.0; t += 0.01) {
      const Eigen::Vector2d place = at + t * (corner - at);
      if (std::abs(place.y()) > 0.05) continue;
      EXPECT_NEAR(place.x(), 5.0, Kerb::kHalfRamp);
    }
    at = corner;
  }
  Kerb closed = kerbAt(1.0);
  closed.ramps.clear();
  const NavigationGrid without(siteWithKerb(closed));
  EXPECT_TRUE(without.path({1.0, 2.5}, {1.0, -2.5}, 0.32).empty());
}

/// What a robot meets on a campus in so many seconds.
struct Drive {
  double lowest = 0.0, steepest = 0.0, widest_bank = 0.0, longest_step = 0.0;
};

Drive driveOnCampus(int seed, double seconds) {
  SimParams params;
  params.world.kind = WorldParams::Kind::kCampus;
  params.world.seed = seed;
  params.route.speed_mps = 1.5;
  params.camera.ride_deg = 0.0;
  params.robot.sudden_stop_rate_hz = 0.0;
  params.traffic.pedestrians = params.traffic.vehicles = params.traffic.cyclists = 0;
  SiteEnvironment place(params, {});
  Drive drive;
  double height = place.T_world_robot().translation().z();
  for (double t = 0.0; t < seconds; t += 0.02) {
    place.advance(0.02);
    const Pose pose = place.T_world_robot();
    const double now = pose.translation().z();
    drive.lowest = std::min(drive.lowest, now);
    drive.longest_step = std::max(drive.longest_step, std::abs(now - height));
    drive.steepest = std::max(drive.steepest, std::abs(std::asin(pose.linear()(2, 0))));
    drive.widest_bank = std::max(drive.widest_bank, std::abs(std::asin(pose.linear()(2, 1))));
    height = now;
  }
  return drive;
}

TEST(CampusKerbTest, RobotsDriveDownTheRampsAndPitchAsSteepAsTheyAre) {
  const double slope = std::atan(0.1 / Kerb::kRun);
  int crossed = 0;
  for (int seed = 1; seed <= 12; ++seed) {
    const Drive drive = driveOnCampus(seed, 20.0);
    EXPECT_GE(drive.lowest, -0.1 - 1e-9) << seed;
    EXPECT_LT(drive.steepest, 2.5 * slope) << seed << ": wheels never fall off a kerb";
    EXPECT_LT(drive.longest_step, 0.02 * 1.6 * 0.3) << seed;
    if (drive.lowest > -0.099) continue;
    ++crossed;
    EXPECT_GT(drive.steepest, 0.95 * slope) << seed;
  }
  EXPECT_GE(crossed, 4);
}

TEST(CampusKerbTest, PeopleCrossTheRoadOnTheGround) {
  SimParams params;
  params.world.kind = WorldParams::Kind::kCampus;
  params.world.seed = 3;
  params.traffic.pedestrians = 20;
  params.robot.standing = true;
  SiteEnvironment place(params, {});
  int on_road = 0;
  for (int i = 0; i < 1500; ++i) {
    place.advance(0.02);
    for (const Actor& actor : place.actors(100.0)) {
      if (!isPerson(actor.kind)) continue;
      const double ground = groundHeight(place.site(), actor.position.head<2>());
      EXPECT_NEAR(actor.position.z(), ground, 1e-9);
      on_road += ground < -0.099 ? 1 : 0;
    }
  }
  EXPECT_GT(on_road, 0);
}

}  // namespace
}  // namespace headway::sim
