// SPDX-License-Identifier: BSD-3-Clause
#include "upright_segments.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "grid.h"

namespace headway::detect {
namespace {

using test::Grid;

constexpr double kBoxDepth = 12.0;
constexpr double kSearchRange = 30.0;

std::vector<UprightSegment> segmentsIn(const Grid& grid) {
  return uprightSegments(grid.disparity, grid.camera, grid.ground, kSearchRange);
}

TEST(UprightSegmentsTest, APersonIsOne) {
  Grid grid;
  const auto cells = grid.draw(1.0, kBoxDepth, 0.6, 0.0, 1.7);
  const auto segments = segmentsIn(grid);
  ASSERT_EQ(segments.size(), 1u);
  const UprightSegment& person = segments[0];
  const Eigen::Vector3d centre = *triangulate(person.uvd, grid.camera);
  EXPECT_NEAR(centre.x(), 1.0, 0.05);
  EXPECT_NEAR(centre.z(), kBoxDepth, 0.05);
  EXPECT_NEAR(person.width_px * kBoxDepth / grid.camera.fx, 0.6, 0.08);
  EXPECT_LT(person.cells.size(), cells.size()) << "feet are too near the ground to be told from it";
  EXPECT_GT(person.cells.size(), 0.8 * static_cast<double>(cells.size()));
  EXPECT_FALSE(person.cut_by_flow);
  EXPECT_FALSE(person.across);
}

struct Other {
  const char* name;
  double width, bottom, top, depth;
};

class NoPersonTest : public testing::TestWithParam<Other> {};

TEST_P(NoPersonTest, IsNoSegment) {
  Grid grid;
  const Other& other = GetParam();
  grid.draw(0.0, other.depth, other.width, other.bottom, other.top);
  EXPECT_TRUE(segmentsIn(grid).empty());
}

INSTANTIATE_TEST_SUITE_P(Sizes, NoPersonTest,
                         testing::Values(Other{"wide", 3.0, 0.0, 1.7, kBoxDepth},
                                         Other{"thin", 0.1, 0.0, 1.7, kBoxDepth},
                                         Other{"low", 0.6, 0.0, 0.7, kBoxDepth},
                                         Other{"pole", 0.4, 0.0, 3.5, kBoxDepth},
                                         Other{"sign", 0.6, 1.4, 2.0, kBoxDepth},
                                         Other{"far", 0.6, 0.0, 1.7, 40.0}),
                         [](const auto& other) { return std::string(other.param.name); });

TEST(UprightSegmentsTest, TwoDepthsSideBySideAreTwo) {
  Grid grid;
  grid.draw(0.0, kBoxDepth, 0.6, 0.0, 1.7);
  grid.draw(0.6, kBoxDepth + 3.0, 0.6, 0.0, 1.7);
  EXPECT_EQ(segmentsIn(grid).size(), 2u);
}

TEST(UprightSegmentsTest, TwoHeadsAreTwo) {
  Grid grid;
  grid.draw(-0.3, kBoxDepth, 1.0, 0.0, 1.3);  // the bodies of two people touch
  grid.draw(-0.6, kBoxDepth, 0.2, 1.3, 1.7);
  grid.draw(0.0, kBoxDepth, 0.2, 1.3, 1.7);
  const auto segments = segmentsIn(grid);
  ASSERT_EQ(segments.size(), 2u);
  EXPECT_LT(segments[0].uvd.x(), segments[1].uvd.x());
}

TEST(UprightSegmentsTest, LegsCutByTheUpperEdgeOfTheImageAreSegments) {
  Grid grid;
  grid.ground.camera_height = 0.5;
  grid.draw(-0.12, 1.0, 0.14, 0.0, 0.9);
  grid.draw(0.12, 1.0, 0.14, 0.0, 0.9);
  EXPECT_EQ(segmentsIn(grid).size(), 2u);
}

TEST(UprightSegmentsTest, PartsCutByTheUpperEdgeOfTheImageAreNoHeads) {
  Grid grid;
  grid.ground.camera_height = 0.5;
  grid.draw(0.0, 1.0, 0.6, 0.0, 0.6);  // a skirt, and arms at both sides
  grid.draw(-0.25, 1.0, 0.1, 0.6, 0.9);
  grid.draw(0.25, 1.0, 0.1, 0.6, 0.9);
  EXPECT_EQ(segmentsIn(grid).size(), 1u);
}

TEST(StandingCellsTest, AreBetweenGroundAndHeadAndWithinRange) {
  Grid grid;
  const auto cells = grid.draw(0.0, kBoxDepth, 0.4, -0.2, 3.0);
  const auto standing = standingCells(grid.disparity, grid.camera, grid.ground, kSearchRange);
  for (const auto& cell : grid.inSpace(cells)) {
    const double height = grid.ground.heightOf(cell.point);
    const bool stands = standing.disparities.at<float>(cell.place) > 0.0F;
    EXPECT_EQ(stands, height > 0.15 && height < 2.4) << height;
    EXPECT_NEAR(standing.heights.at<double>(cell.place), height, 1e-4);
  }
  const auto near = standingCells(grid.disparity, grid.camera, grid.ground, kBoxDepth - 1.0);
  EXPECT_EQ(cv::countNonZero(near.disparities), 0);
}

}  // namespace
}  // namespace headway::detect
