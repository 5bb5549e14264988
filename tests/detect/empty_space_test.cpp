// SPDX-License-Identifier: BSD-3-Clause
#include "empty_space.h"

#include <gtest/gtest.h>

#include "grid.h"
#include "newcomers.h"

namespace headway::detect {
namespace {

using test::Grid;

constexpr double kReach = 7.0;
constexpr double kWall = 6.0;    // depth of a wall [m]
constexpr double kPerson = 3.0;  // and of a person before it [m]

/// A camera that stands, and what it sees.
class EmptySpaceTest : public testing::Test {
 protected:
  /// Cells that are new in a frame, and how many of them the person covers.
  struct Newcomers {
    int all = 0, person = 0, person_cells = 0;
  };

  /// @param person  its middle, to the right of the camera [m]; none: not there
  Newcomers see(std::optional<double> person) {
    Grid grid;
    grid.draw(0.0, kWall, 12.0, 0.0, 2.3);
    std::vector<cv::Point> cells;
    if (person) cells = grid.draw(*person, kPerson, 0.5, 0.0, 1.7);
    path_.advance(0.1 * frame_++, Pose::Identity());
    standing_ = standingCells(grid.disparity, grid.camera, grid.ground, kReach);
    is_new_ = space_.enter(grid.disparity, standing_, grid.ground, {}, path_, grid.ground.up);
    disparity_ = grid.disparity;
    Newcomers seen;
    seen.all = cv::countNonZero(is_new_ == EmptySpace::kNew);
    for (const auto& cell : cells) {
      if (standing_.disparities.at<float>(cell) <= 0.0F) continue;
      ++seen.person_cells;
      seen.person += is_new_.at<unsigned char>(cell) == EmptySpace::kNew ? 1 : 0;
    }
    return seen;
  }

  Grid camera_;
  CameraPath path_{camera_.camera, 0.3};
  EmptySpace space_{camera_.camera, kReach};
  int frame_ = 0;
  StandingCells standing_;
  stereo::DisparityImage disparity_;
  cv::Mat is_new_;
};

TEST_F(EmptySpaceTest, WhoEntersItIsNewAndTheWallIsNot) {
  for (int i = 0; i < 10; ++i) EXPECT_EQ(see(std::nullopt).all, 0) << i;
  const auto seen = see(0.0);
  EXPECT_GT(seen.person, 0.8 * seen.person_cells);
  EXPECT_EQ(seen.person, seen.all);
}

TEST_F(EmptySpaceTest, WhoStoodThereFromTheFirstIsNotNew) {
  for (int i = 0; i < 20; ++i) EXPECT_EQ(see(0.0).all, 0) << i;
}

TEST_F(EmptySpaceTest, SingleFramesProveNothing) {
  for (int i = 0; i < 20; ++i) EXPECT_EQ(see(0.0).all, 0) << i;
  EXPECT_EQ(see(std::nullopt).all, 0);
  EXPECT_EQ(see(0.0).all, 0) << "a frame without him does not make him new";
}

TEST_F(EmptySpaceTest, ANewcomerWhoStaysBecomesPartOfTheScene) {
  for (int i = 0; i < 20; ++i) see(std::nullopt);
  for (int i = 0; i < 100; ++i) EXPECT_GT(see(0.0).person, 0) << i << ": 10 s";
  for (int i = 0; i < 200; ++i) see(0.0);
  EXPECT_EQ(see(0.0).all, 0) << "30 s";
}

TEST_F(EmptySpaceTest, ItForgets) {
  for (int i = 0; i < 10; ++i) see(std::nullopt);
  space_.clear();
  EXPECT_EQ(see(0.0).all, 0);
}

// --- Newcomers: cells grouped by where they stand. ---

struct Body {
  double x, depth, width, bottom, top;
};

std::vector<UprightSegment> newcomersOf(const std::vector<Body>& bodies) {
  Grid grid;
  cv::Mat is_new(grid.disparity.values.size(), CV_8U, cv::Scalar(0));
  for (const Body& body : bodies) {
    for (const auto& cell : grid.draw(body.x, body.depth, body.width, body.bottom, body.top)) {
      is_new.at<unsigned char>(cell) = EmptySpace::kNew;
    }
  }
  const auto standing = standingCells(grid.disparity, grid.camera, grid.ground, kReach);
  is_new.setTo(0, standing.disparities <= 0.0F);
  return newcomers(is_new, standing, grid.disparity, grid.camera, grid.ground);
}

TEST(NewcomersTest, TwoWhoWalkSideBySideAreTwo) {
  const auto found = newcomersOf({{-0.3, 4.0, 0.45, 0.0, 1.75}, {0.3, 4.1, 0.45, 0.0, 1.75}});
  ASSERT_EQ(found.size(), 2u);
  for (const auto& segment : found) EXPECT_TRUE(segment.is_new);
}

TEST(NewcomersTest, OneWhoWalksAfterTheOtherIsAnother) {
  EXPECT_EQ(newcomersOf({{-0.3, 4.6, 0.45, 0.0, 1.75}, {0.1, 4.0, 0.45, 0.0, 1.75}}).size(), 2u);
}

TEST(NewcomersTest, TheLegsOfAStrideBelongToOnePerson) {
  const auto found = newcomersOf(
      {{0.0, 4.0, 0.45, 0.85, 1.75}, {-0.25, 4.0, 0.14, 0.0, 0.85}, {0.25, 3.9, 0.14, 0.0, 0.85}});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(triangulate(found[0].uvd, Grid().camera)->x(), 0.0, 0.15);
}

TEST(NewcomersTest, WhatIsLowOrSmallIsLeftOut) {
  EXPECT_TRUE(newcomersOf({{0.0, 4.0, 0.6, 0.0, 0.7}}).empty()) << "a box";
  EXPECT_TRUE(newcomersOf({{0.0, 4.0, 0.1, 1.0, 1.5}}).empty()) << "a wrong match";
  EXPECT_TRUE(newcomersOf({}).empty());
}

}  // namespace
}  // namespace headway::detect
