// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/map/track_geometry.h>
#include <mrpt/opengl/CSetOfTriangles.h>

#include "example_world.h"

namespace headway::map {
namespace {

const std::vector<Eigen::Vector3d> kTenMetres = {{0, 0, 0}, {4, 0, 0}, {4, 6, 0}};

TEST(BoxCornersTest, FrontLeftBottomIsFirst) {
  Track track;
  track.position = {10.0, 5.0, 1.0};
  track.size = {4.0, 2.0, 1.5};
  const auto corners = boxCorners(track);
  EXPECT_TRUE(corners[0].isApprox(Eigen::Vector3d(12.0, 6.0, 0.25)));
  EXPECT_TRUE(corners[1].isApprox(Eigen::Vector3d(12.0, 4.0, 0.25)));
  EXPECT_TRUE(corners[6].isApprox(Eigen::Vector3d(8.0, 4.0, 1.75)));
}

TEST(BoxCornersTest, TurnWithTheYawAboutTheCentre) {
  Track track;
  track.position = {10.0, 5.0, 1.0};
  track.size = {4.0, 2.0, 1.5};
  track.yaw = 1.5707963267948966;
  EXPECT_TRUE(boxCorners(track)[0].isApprox(Eigen::Vector3d(9.0, 7.0, 0.25), 1e-9));
}

TEST(BoxEdgesTest, JoinCornersThatDifferInOneDimension) {
  const auto track = exampleTrack(1, ObjectClass::kCar, {1, 2, 3}, 0.7);
  const auto corners = boxCorners(track);
  double total = 0.0;
  for (const auto& [a, b] : kBoxEdges) {
    total += (corners[static_cast<std::size_t>(a)] - corners[static_cast<std::size_t>(b)]).norm();
  }
  EXPECT_NEAR(total, 4.0 * track.size.sum(), 1e-9);
}

TEST(GroundTrailTest, EndsUnderThePresentPlace) {
  const auto track = exampleTrack(1, ObjectClass::kCar, {10, 2, 0.8}, 0.3);
  const auto trail = groundTrail(track);
  EXPECT_EQ(trail.size(), track.recent_path.size() + 1);
  EXPECT_TRUE(trail.back().isApprox(Eigen::Vector3d(10, 2, 0.05), 1e-9));
}

TEST(GroundPathTest, StartsUnderThePresentPlace) {
  const auto track = exampleTrack(1, ObjectClass::kCar, {10, 2, 0.8}, 0.3);
  const auto path = groundPath(track, track.predictions[0]);
  EXPECT_EQ(path.size(), 31u);
  EXPECT_TRUE(path.front().isApprox(Eigen::Vector3d(10, 2, 0.05), 1e-9));
  EXPECT_NEAR(lengthOf(path), 15.0, 1e-9);
}

TEST(DashesOfTest, CoverTheWayInTurnsOfDashAndGap) {
  const auto dashes = dashesOf(kTenMetres, 1.5, 1.0);
  ASSERT_EQ(dashes.size(), 4u);
  double drawn = 0.0;
  for (const auto& dash : dashes) drawn += lengthOf(dash);
  EXPECT_NEAR(drawn, 6.0, 1e-9);
  EXPECT_TRUE(dashes[1].front().isApprox(Eigen::Vector3d(2.5, 0, 0)));
  EXPECT_EQ(dashes[1].size(), 2u);
}

TEST(DashesOfTest, GoRoundBends) {
  const auto dashes = dashesOf(kTenMetres, 5.0, 1.0);
  ASSERT_EQ(dashes.size(), 2u);
  ASSERT_EQ(dashes[0].size(), 3u);
  EXPECT_TRUE(dashes[0][1].isApprox(Eigen::Vector3d(4, 0, 0)));
  EXPECT_TRUE(dashes[0][2].isApprox(Eigen::Vector3d(4, 1, 0)));
}

TEST(DashesOfTest, AreNoneWhereThereIsNoWay) {
  EXPECT_TRUE(dashesOf({}, 1.0, 1.0).empty());
  EXPECT_TRUE(dashesOf({{1, 1, 1}, {1, 1, 1}}, 1.0, 1.0).empty());
}

TEST(AppendRibbonTest, HasTheGivenWidthAndIsLevel) {
  mrpt::opengl::CSetOfTriangles triangles;
  appendRibbon({{0, 0, 1}, {3, 0, 1}}, 0.5, kPredictionColour, 200.0, triangles);
  ASSERT_EQ(triangles.getTrianglesCount(), 2u);
  mrpt::opengl::TTriangle triangle;
  triangles.getTriangle(0, triangle);
  EXPECT_FLOAT_EQ(triangle.vertex(0).y, 0.25f);
  EXPECT_FLOAT_EQ(triangle.vertex(1).y, -0.25f);
  EXPECT_FLOAT_EQ(triangle.vertex(2).z, 1.f);
  EXPECT_EQ(triangle.a(0), 200);
  EXPECT_EQ(triangle.g(0), kPredictionColour.green);
}

TEST(AppendRibbonTest, AddsNothingForASinglePoint) {
  mrpt::opengl::CSetOfTriangles triangles;
  appendRibbon({{0, 0, 1}}, 0.5, kPredictionColour, 200.0, triangles);
  EXPECT_EQ(triangles.getTrianglesCount(), 0u);
}

}  // namespace
}  // namespace headway::map
