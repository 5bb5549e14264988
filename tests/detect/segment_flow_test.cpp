// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "grid.h"
#include "upright_segments.h"

namespace headway::detect {
namespace {

using test::Grid;

constexpr double kDepth = 12.0;
constexpr double kRange = 30.0;
constexpr double kSpeed = 1.4;  // to the right [m/s]

/// A flow that is zero wherever there are disparities.
ResidualFlow zeroFlow(const Grid& grid) {
  ResidualFlow flow;
  const cv::Size size = grid.disparity.values.size();
  flow.columns = cv::Mat(size, CV_32F, cv::Scalar(0));
  flow.columns.setTo(std::nanf(""), grid.disparity.values <= 0.0F);
  flow.sigmas = cv::Mat(size, CV_32F, cv::Scalar(0.3));
  flow.seconds = test::kFrameStep;
  return flow;
}

/// Flow of a speed at the walker's depth [px].
float flowOf(const Grid& grid, double speed) {
  return static_cast<float>(speed * test::kFrameStep * grid.camera.fx / kDepth);
}

std::vector<UprightSegment> segmentsIn(const Grid& grid, const ResidualFlow& flow) {
  return segmentsByFlow(grid.disparity, flow, grid.camera,
                        standingCells(grid.disparity, grid.camera, grid.ground, kRange), {});
}

TEST(SegmentsByFlowTest, WithoutFlowTheyAreThoseOfTheDisparities) {
  Grid grid;
  grid.draw(0.0, kDepth, 0.6, 0.0, 1.7);
  const auto segments = segmentsIn(grid, {});
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_FALSE(segments[0].across);
}

TEST(SegmentsByFlowTest, MeasureTheSpeedAcrossTheLineOfSight) {
  for (const double speed : {kSpeed, 0.0, -kSpeed}) {
    Grid grid;
    const auto cells = grid.draw(0.0, kDepth, 0.6, 0.0, 1.7);
    auto flow = zeroFlow(grid);
    for (const auto& cell : cells) flow.columns.at<float>(cell) = flowOf(grid, speed);
    const auto segments = segmentsIn(grid, flow);
    ASSERT_EQ(segments.size(), 1u) << "what moves as a whole is not cut out once more";
    ASSERT_TRUE(segments[0].across);
    EXPECT_NEAR(segments[0].across->speed, speed, 0.05);
    EXPECT_GT(segments[0].across->sigma, 0.0);
    EXPECT_EQ(segments[0].across->seconds, test::kFrameStep);
  }
}

TEST(SegmentsByFlowTest, AWalkerInFrontOfAWallIsCutOut) {
  Grid grid;
  grid.draw(0.0, kDepth, 8.0, 0.0, 2.3);  // a wall, at the walker's depth
  const auto walker = grid.draw(0.0, kDepth, 0.6, 0.0, 1.7);
  auto flow = zeroFlow(grid);
  EXPECT_TRUE(segmentsIn(grid, flow).empty()) << "the wall is no segment";
  for (const auto& cell : walker) flow.columns.at<float>(cell) = flowOf(grid, kSpeed);
  const auto segments = segmentsIn(grid, flow);
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_TRUE(segments[0].cut_by_flow);
  ASSERT_TRUE(segments[0].across);
  EXPECT_NEAR(segments[0].across->speed, kSpeed, 0.1);
}

TEST(SegmentsByFlowTest, TwoWhoPassEachOtherAreCutApart) {
  Grid grid;
  grid.draw(0.0, kDepth, 8.0, 0.0, 2.3);
  auto flow = zeroFlow(grid);
  const auto left = grid.draw(-0.4, kDepth, 0.6, 0.0, 1.7);
  const auto right = grid.draw(0.4, kDepth, 0.6, 0.0, 1.7);
  for (const auto& cell : left) flow.columns.at<float>(cell) = flowOf(grid, kSpeed);
  for (const auto& cell : right) flow.columns.at<float>(cell) = flowOf(grid, -kSpeed);
  const auto segments = segmentsIn(grid, flow);
  ASSERT_EQ(segments.size(), 2u);
  EXPECT_LT(segments[0].across->speed * segments[1].across->speed, 0.0);
}

TEST(SegmentsByFlowTest, FlowWithinItsNoiseCutsNothingOut) {
  Grid grid;
  grid.draw(0.0, kDepth, 8.0, 0.0, 2.3);
  const auto walker = grid.draw(0.0, kDepth, 0.6, 0.0, 1.7);
  auto flow = zeroFlow(grid);
  for (const auto& cell : walker) flow.columns.at<float>(cell) = flowOf(grid, kSpeed);
  flow.sigmas.setTo(5.0);
  EXPECT_TRUE(segmentsIn(grid, flow).empty());
}

TEST(SegmentsByFlowTest, WithoutKnownFlowNoSpeedIsMeasured) {
  Grid grid;
  grid.draw(0.0, kDepth, 0.6, 0.0, 1.7);
  auto flow = zeroFlow(grid);
  flow.columns.setTo(std::nanf(""));
  const auto segments = segmentsIn(grid, flow);
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_FALSE(segments[0].across);
}

}  // namespace
}  // namespace headway::detect
