// SPDX-License-Identifier: BSD-3-Clause
// Laws of laser scans of simple meshes.
#include <gtest/gtest.h>

#include <cmath>

#include "robot_sensors.h"
#include "site.h"

namespace headway::sim {
namespace {

LaserParams exact() {
  LaserParams params;
  params.sigma_m = 0.0;
  params.miss_ratio = 0.0;
  params.forward_m = 0.0;
  return params;
}

/// Four walls of a room of 8 m x 4 m about the origin, their inner faces 3.93 m and 1.93 m away.
Site room() {
  Site site;
  SiteBuilder builder(site);
  builder.wall({-4, -2}, {4, -2}, 2.5, Material::kPlaster);
  builder.wall({-4, 2}, {4, 2}, 2.5, Material::kPlaster);
  builder.wall({-4, -2}, {-4, 2}, 2.5, Material::kPlaster);
  builder.wall({4, -2}, {4, 2}, 2.5, Material::kPlaster);
  return site;
}

float rangeAt(const io::RecordedScan& scan, double angle) {
  const auto last = static_cast<double>(scan.ranges.size() - 1);
  const double ray = (angle + 0.5 * scan.aperture_rad) / scan.aperture_rad * last;
  return scan.ranges.at(static_cast<std::size_t>(std::lround(ray)));
}

io::RecordedScan scanRoom(const LaserParams& params, const Pose& T_world_robot,
                          const std::vector<Mesh>& actors = {}) {
  const Site site = room();
  const Mesh& mesh = site.surfaces.at(Material::kPlaster);
  return LaserScanner(params, 1).scan(0.0, T_world_robot, {{&mesh}}, actors);
}

TEST(LaserScannerTest, MeasuresTheWallsOfARoomAllAround) {
  LaserParams params = exact();
  params.aperture_deg = 360.0;
  params.rays = 721;
  const io::RecordedScan scan = scanRoom(params, Pose::Identity());
  ASSERT_EQ(scan.ranges.size(), 721U);
  EXPECT_NEAR(rangeAt(scan, 0.0), 3.93, 1e-4);
  EXPECT_NEAR(rangeAt(scan, M_PI / 2), 1.93, 1e-4);
  EXPECT_NEAR(rangeAt(scan, -M_PI / 2), 1.93, 1e-4);
  EXPECT_NEAR(rangeAt(scan, M_PI), 3.93, 1e-4);
  EXPECT_NEAR(rangeAt(scan, -M_PI), 3.93, 1e-4);
  for (const float range : scan.ranges) EXPECT_GT(range, 1.9F);
}

TEST(LaserScannerTest, TurnsWithTheRobot) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(1.0, 0.5, 0.0);
  const io::RecordedScan scan = scanRoom(exact(), pose);
  EXPECT_NEAR(rangeAt(scan, 0.0), 1.43, 1e-4);        // to the north
  EXPECT_NEAR(rangeAt(scan, M_PI / 2), 4.93, 1e-4);   // to the west
  EXPECT_NEAR(rangeAt(scan, -M_PI / 2), 2.93, 1e-4);  // to the east
}

TEST(LaserScannerTest, AnActorHidesTheWallBehindIt) {
  Site box;
  SiteBuilder(box).box({{2.0, 0.0}, 0.0, {0.4, 0.4, 1.7}, 0.0}, Material::kWood);
  const io::RecordedScan scan =
      scanRoom(exact(), Pose::Identity(), {box.surfaces.at(Material::kWood)});
  EXPECT_NEAR(rangeAt(scan, 0.0), 1.8, 1e-4);
  EXPECT_NEAR(rangeAt(scan, 0.3), 3.93 / std::cos(0.3), 0.05);
}

TEST(LaserScannerTest, WhatIsLowerThanItsPlaneIsNotSeen) {
  Site box;
  SiteBuilder(box).box({{2.0, 0.0}, 0.0, {0.4, 0.4, 0.15}, 0.0}, Material::kWood);
  const io::RecordedScan scan =
      scanRoom(exact(), Pose::Identity(), {box.surfaces.at(Material::kWood)});
  EXPECT_NEAR(rangeAt(scan, 0.0), 3.93, 1e-4);
}

TEST(LaserScannerTest, OutOfRangeIsNoMeasurement) {
  LaserParams params = exact();
  params.max_range_m = 3.0;
  params.min_range_m = 2.0;
  const io::RecordedScan scan = scanRoom(params, Pose::Identity());
  EXPECT_EQ(rangeAt(scan, 0.0), 0.0F);       // too far
  EXPECT_EQ(rangeAt(scan, M_PI / 2), 0.0F);  // too near
  EXPECT_GT(rangeAt(scan, 0.9), 2.0F);
}

TEST(LaserScannerTest, NoiseHasTheStandardDeviationAskedFor) {
  LaserParams params = exact();
  const io::RecordedScan clean = scanRoom(params, Pose::Identity());
  params.sigma_m = 0.02;
  params.miss_ratio = 0.1;
  const io::RecordedScan noisy = scanRoom(params, Pose::Identity());
  double squares = 0.0;
  int count = 0, lost = 0;
  for (std::size_t i = 0; i < clean.ranges.size(); ++i) {
    if (noisy.ranges[i] == 0.0F) {
      ++lost;
      continue;
    }
    squares += std::pow(noisy.ranges[i] - clean.ranges[i], 2);
    ++count;
  }
  EXPECT_NEAR(std::sqrt(squares / count), 0.02, 0.003);
  EXPECT_NEAR(lost / static_cast<double>(clean.ranges.size()), 0.1, 0.04);
}

}  // namespace
}  // namespace headway::sim
