// SPDX-License-Identifier: BSD-3-Clause
// Laws of what is built into a site.
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <set>

#include "site.h"
#include "site_furniture.h"

namespace headway::sim {
namespace {

Eigen::AlignedBox3f extent(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const auto& triangle : mesh.triangles) {
    for (const auto& vertex : triangle) box.extend(vertex.position);
  }
  return box;
}

double areaOf(const Mesh& mesh) {
  double area = 0.0;
  for (const auto& t : mesh.triangles) {
    area += 0.5 * (t[1].position - t[0].position).cross(t[2].position - t[0].position).norm();
  }
  return area;
}

TEST(SiteBuilderTest, ABoxHasItsSizeAndBlocks) {
  Site site;
  SiteBuilder(site).box({{1, 2}, 0.0, {2.0, 1.0, 0.5}, 0.1}, Material::kWood);
  const auto box = extent(site.surfaces.at(Material::kWood));
  EXPECT_TRUE(box.min().isApprox(Eigen::Vector3f(0, 1.5F, 0.1F), 1e-5F));
  EXPECT_TRUE(box.max().isApprox(Eigen::Vector3f(2, 2.5F, 0.6F), 1e-5F));
  ASSERT_EQ(site.obstacles.size(), 1U);
  EXPECT_EQ(site.obstacles[0].size, Eigen::Vector2d(2.0, 1.0));
}

TEST(SiteBuilderTest, WhatHangsAboveHeadsOrLiesFlatDoesNotBlock) {
  Site site;
  SiteBuilder builder(site);
  builder.box({{1, 2}, 0.0, {2.0, 1.0, 0.5}, 2.1}, Material::kWood);
  builder.box({{1, 2}, 0.0, {2.0, 1.0, 0.02}, 0.0}, Material::kWood);
  builder.ornament({{1, 2}, 0.0, {2.0, 1.0, 0.5}, 0.5}, Material::kWood);
  EXPECT_TRUE(site.obstacles.empty());
}

TEST(SiteBuilderTest, AFloorCoversAllButItsHoles) {
  Site site;
  SiteBuilder(site).floor(rectangle(0, 0, 10, 6), 0.0, Material::kConcrete,
                          {rectangle(2, 1, 4, 3), rectangle(8, 5, 12, 9)});
  EXPECT_NEAR(areaOf(site.surfaces.at(Material::kConcrete)), 60.0 - 4.0 - 2.0, 1e-4);
}

TEST(SiteBuilderTest, AWallHasADoorButIsClosedBelowAWindow) {
  Site site;
  SiteBuilder(site).wall({0, 0}, {8, 0}, 2.8, Material::kPlaster,
                         {{2.0, 1.0, 0.0, 2.1}, {6.0, 1.0, 0.9, 2.3}});
  const auto blocks = [&](double x) {
    return std::any_of(site.obstacles.begin(), site.obstacles.end(), [&](const Footprint& o) {
      return std::abs(x - o.centre.x()) < 0.5 * o.size.x();
    });
  };
  EXPECT_FALSE(blocks(2.0));
  EXPECT_TRUE(blocks(6.0));
  EXPECT_TRUE(blocks(4.0));
}

TEST(SiteBuilderTest, APitIsAnImpassableDrop) {
  Site site;
  SiteBuilder builder(site);
  builder.pit(rectangle(1, 1, 3, 2), 1.5, Material::kConcrete);
  builder.stairsDown(rectangle(1, 1, 3, 2), 1.5, true, Material::kConcrete);
  ASSERT_EQ(site.drops.size(), 1U);
  EXPECT_EQ(site.drops[0].depth_m, 1.5);
  EXPECT_EQ(site.drops[0].outline.size(), 4U);
  EXPECT_EQ(site.edges.size(), 1U);
  EXPECT_TRUE(site.obstacles.empty());  // nothing stands there that would darken the floor
  const auto box = extent(site.surfaces.at(Material::kConcrete));
  EXPECT_NEAR(box.min().z(), -1.5F, 1e-5F);
  EXPECT_LE(box.max().z(), 1e-5F);  // nothing stands above the floor
}

TEST(SiteBuilderTest, StairsLeadDownTheWayThatIsAsked) {
  for (const bool towards_positive : {true, false}) {
    Site site;
    SiteBuilder(site).stairsDown(rectangle(0, 0, 3, 1), 1.7, towards_positive, Material::kSteel);
    float high = -10.0F, x_high = 0.0F;
    for (const auto& triangle : site.surfaces.at(Material::kSteel).triangles) {
      for (const auto& vertex : triangle) {
        if (vertex.position.z() <= high) continue;
        high = vertex.position.z();
        x_high = vertex.position.x();
      }
    }
    EXPECT_EQ(x_high < 1.5F, towards_positive);
    EXPECT_NEAR(high, -0.17F, 1e-5F);
  }
}

TEST(SiteFurnitureTest, ChairsAndSofasAreSeats) {
  Site site;
  SiteBuilder builder(site);
  Random random(1);
  addDesk(builder, {{0, 0}, 0.0}, random);
  addSofa(builder, {{5, 0}, 0.0});
  EXPECT_EQ(site.spots.size(), 3U);
  for (const Spot& spot : site.spots) EXPECT_TRUE(spot.seat);
}

TEST(SiteFurnitureTest, ARackBayBlocksItsWholeFootprintAndCarriesLoads) {
  Site site;
  SiteBuilder builder(site);
  Random random(1);
  addRackBay(builder, {{0, 0}, 0.0}, random);
  EXPECT_EQ(site.obstacles.back().size, Eigen::Vector2d(2.7, 1.1));
  EXPECT_GT(site.surfaces.count(Material::kPallet), 0U);
  EXPECT_GT(extent(site.surfaces.at(Material::kPallet)).max().z(), 3.0F);
}

TEST(MaterialTest, EveryMaterialHasAPictureOfPowersOfTwo) {
  const Grain grain(1);
  for (int i = 0; i <= static_cast<int>(Material::kSoil); ++i) {
    Random random(2);
    const cv::Mat picture = drawMaterial(static_cast<Material>(i), grain, random);
    EXPECT_EQ(picture.type(), CV_8UC3);
    EXPECT_EQ(picture.rows & (picture.rows - 1), 0);
    EXPECT_EQ(picture.rows, picture.cols);
    EXPECT_GT(pictureSize(static_cast<Material>(i)), 0.3);
    cv::Scalar mean, deviation;
    cv::meanStdDev(picture, mean, deviation);
    if (static_cast<Material>(i) == Material::kLamp) continue;
    EXPECT_GT(deviation[1], 1.0) << i;  // nothing real is without any texture
  }
}

}  // namespace
}  // namespace headway::sim
