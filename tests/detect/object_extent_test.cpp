// SPDX-License-Identifier: BSD-3-Clause
#include "object_extent.h"

#include <gtest/gtest.h>

#include "grid.h"

namespace headway::detect {
namespace {

using test::Grid;

constexpr double kBodyDepth = 12.0;
const Eigen::Vector3d kRight(1.5, 0.0, 0.0);  // a walker's velocity [m/s]

std::vector<ObjectCell> grown(const Grid& grid, const Eigen::Vector3d& seed) {
  return growObject({seed}, grid.disparity, grid.camera, grid.ground);
}

/// On the object at a place, one metre above the ground.
Eigen::Vector3d seedAt(double x, double depth) { return {x, 0.65, depth}; }

TEST(GrowObjectTest, CoversTheObjectAboveTheGround) {
  Grid grid;
  const auto cells = grid.draw(0.0, kBodyDepth, 0.6, 0.0, 1.7);
  const auto object = grown(grid, seedAt(0.0, kBodyDepth));
  EXPECT_GT(object.size(), 0.85 * static_cast<double>(cells.size()));
  for (const auto& cell : object) EXPECT_GT(grid.ground.heightOf(cell.point), 0.15);
}

TEST(GrowObjectTest, StopsAtAStepOfDisparity) {
  Grid grid;
  grid.draw(0.0, kBodyDepth, 0.6, 0.0, 1.7);
  grid.draw(0.6, kBodyDepth + 3.0, 0.6, 0.0, 1.7);
  for (const auto& cell : grown(grid, seedAt(0.0, kBodyDepth))) {
    EXPECT_NEAR(cell.point.z(), kBodyDepth, 0.1);
  }
}

TEST(GrowObjectTest, StopsFarFromItsSeeds) {
  Grid grid;
  grid.draw(0.0, kBodyDepth, 8.0, 0.0, 1.7);  // a wall
  for (const auto& cell : grown(grid, seedAt(0.0, kBodyDepth))) {
    EXPECT_LT(std::abs(cell.point.x()), 1.0);
  }
}

TEST(GrowObjectTest, BridgesAColumnWithoutDisparities) {
  Grid grid;
  grid.draw(0.0, kBodyDepth, 0.6, 0.0, 1.7);
  const int middle = grid.disparity.cellOf(grid.camera.cx);
  grid.disparity.values.col(middle + 2).setTo(0.0F);
  int left = 0;
  int right = 0;
  for (const auto& cell : grown(grid, seedAt(0.0, kBodyDepth))) {
    ++(cell.place.x < middle + 2 ? left : right);
  }
  EXPECT_GT(left, 100);
  EXPECT_GT(right, 100);
}

TEST(GrowObjectTest, IsEmptyWithoutADisparityAtItsSeeds) {
  const Grid grid;
  EXPECT_TRUE(grown(grid, seedAt(0.0, kBodyDepth)).empty());
  EXPECT_TRUE(grown(grid, {0.0, 0.0, -5.0}).empty()) << "behind the camera";
}

MeasuredVelocity known(const Eigen::Vector3d& velocity, double sigma = 0.1) {
  return {velocity, sigma * sigma * Eigen::Matrix3d::Identity()};
}

std::optional<ObjectExtent> extentIn(Grid& grid, double width, double bottom, double top,
                                     const Eigen::Vector3d& velocity) {
  const auto cells = grid.inSpace(grid.draw(0.0, kBodyDepth, width, bottom, top));
  return extentOf(cells, known(velocity), grid.disparity, grid.camera, grid.ground);
}

TEST(ExtentOfTest, AWalkersBoxStandsOnTheGroundAlongHisVelocity) {
  Grid grid;
  const auto extent = extentIn(grid, 0.6, 0.2, 1.7, kRight);
  ASSERT_TRUE(extent);
  EXPECT_EQ(extent->object_class, ObjectClass::kPedestrian);
  EXPECT_NEAR(extent->box.yaw, 0.0, 1e-6) << "to the right";
  EXPECT_NEAR(extent->box.height, 1.7, 0.1);
  EXPECT_NEAR(grid.ground.heightOf(extent->box.centre), 0.5 * extent->box.height, 1e-6);
  EXPECT_NEAR(extent->box.centre.x(), 0.0, 0.1);
  EXPECT_GE(extent->box.centre.z(), kBodyDepth) << "completed behind the visible side";
  EXPECT_NEAR(extent->surface.z(), kBodyDepth, 0.05);
  const Box2d& box = extent->box2d;
  EXPECT_NEAR(box.width() * kBodyDepth / grid.camera.fx, 0.6, 0.1);
  EXPECT_GT(extent->centre_covariance(2, 2), extent->centre_covariance(0, 0));
}

TEST(ExtentOfTest, SizeAndSpeedSuggestTheClass) {
  Grid person, cyclist, fast, car, van, truck;
  EXPECT_EQ(extentIn(cyclist, 0.6, 0.2, 1.7, 3.0 * kRight)->object_class, ObjectClass::kCyclist);
  EXPECT_EQ(extentIn(fast, 0.6, 0.2, 1.5, 8.0 * kRight)->object_class, ObjectClass::kCar);
  EXPECT_EQ(extentIn(car, 3.0, 0.2, 1.5, kRight)->object_class, ObjectClass::kCar);
  EXPECT_EQ(extentIn(van, 3.0, 0.2, 2.2, kRight)->object_class, ObjectClass::kVan);
  EXPECT_EQ(extentIn(truck, 3.0, 0.2, 3.2, kRight)->object_class, ObjectClass::kTruck);
}

TEST(ExtentOfTest, ErrorsOfTheDepthDoNotMakeAPersonAVehicle) {
  for (const double depth : {12.0, 25.0}) {
    Grid grid;
    auto cells = grid.inSpace(grid.draw(0.0, depth, 0.6, 0.2, 1.7));
    for (auto& cell : cells) {
      const double error = cell.place.y % 2 == 0 ? 0.8 : -0.8;  // two sigmas [px]
      const double d = grid.disparity.values.at<float>(cell.place) + error;
      cell.point = *triangulate(
          {grid.disparity.pixelOf(cell.place.x), grid.disparity.pixelOf(cell.place.y), d},
          grid.camera);
    }
    for (const Eigen::Vector3d& velocity : {kRight, Eigen::Vector3d(0.0, 0.0, 1.5)}) {
      const auto extent =
          extentOf(cells, known(velocity), grid.disparity, grid.camera, grid.ground);
      ASSERT_TRUE(extent);
      EXPECT_EQ(extent->object_class, ObjectClass::kPedestrian) << "at " << depth << " m";
    }
  }
}

TEST(ExtentOfTest, ASmallRigDoesNotMakeAPersonWhoComesCloserAVehicle) {
  Grid grid;
  grid.camera.baseline_m = 0.12;
  const double depth = 8.5;
  auto cells = grid.inSpace(grid.draw(0.0, depth, 0.6, 0.2, 1.7));
  for (auto& cell : cells) {
    const double error = (cell.place.y % 3 - 1) * 1.1;  // three sigmas [px]
    const double d = grid.disparity.values.at<float>(cell.place) + error;
    cell.point = *triangulate(
        {grid.disparity.pixelOf(cell.place.x), grid.disparity.pixelOf(cell.place.y), d},
        grid.camera);
  }
  const auto extent =
      extentOf(cells, known({0.0, 0.0, -2.0}), grid.disparity, grid.camera, grid.ground);
  ASSERT_TRUE(extent);
  EXPECT_EQ(extent->object_class, ObjectClass::kPedestrian);
}

TEST(ExtentOfTest, AnUncertainSpeedDoesNotMakeAPersonAVehicle) {
  Grid grid;
  const auto cells = grid.inSpace(grid.draw(0.0, kBodyDepth, 0.6, 0.2, 1.7));
  for (const double sigma : {0.5, 4.0}) {
    const auto extent =
        extentOf(cells, known({0.0, 0.0, 12.0}, sigma), grid.disparity, grid.camera, grid.ground);
    ASSERT_TRUE(extent);
    EXPECT_EQ(extent->object_class == ObjectClass::kCar, sigma < 1.0);
  }
}

TEST(ExtentOfTest, WhatFloatsBeforeVisibleGroundHasNone) {
  Grid grid;
  const auto cells = grid.inSpace(grid.draw(0.0, 6.0, 0.6, 0.6, 1.2));
  EXPECT_TRUE(extentOf(cells, known(kRight), grid.disparity, grid.camera, grid.ground));
  grid.draw(0.0, 7.0, 3.0, 0.0, 0.1);  // the ground, seen where a lower part should be
  EXPECT_FALSE(extentOf(cells, known(kRight), grid.disparity, grid.camera, grid.ground));
}

TEST(ExtentOfTest, ACarSeenFromBehindIsCompletedToItsUsualLength) {
  Grid grid;
  const auto extent = extentIn(grid, 1.7, 0.2, 1.5, {0.0, 0.0, 12.0});
  ASSERT_TRUE(extent);
  EXPECT_NEAR(extent->box.yaw, -M_PI_2, 1e-6);
  EXPECT_NEAR(extent->box.length, 4.0, 0.1);
  EXPECT_NEAR(extent->box.centre.z(), kBodyDepth + 2.0, 0.3);
  EXPECT_NEAR(extent->box.width, 1.7, 0.15);
}

TEST(ExtentOfTest, TooFewCellsAndWhatFloatsHaveNone) {
  Grid grid;
  const auto cells = grid.inSpace(grid.draw(0.0, kBodyDepth, 0.6, 0.0, 1.7));
  EXPECT_FALSE(extentOf({cells.begin(), cells.begin() + 3}, known(kRight), grid.disparity,
                        grid.camera, grid.ground));
  Grid sign;
  EXPECT_FALSE(extentIn(sign, 0.6, 1.5, 2.3, kRight));
}

TEST(ExtentOfTest, WhatIsSeenTooLowHasNoneUnlessTheImageCutsItOff) {
  Grid low, lowest, cut_off;
  EXPECT_TRUE(extentIn(low, 0.6, 0.0, 0.5, kRight));
  EXPECT_FALSE(extentIn(lowest, 0.6, 0.0, 0.3, kRight));
  // 5 m ahead the lower edge of the image is 0.35 m above the ground.
  const auto cells = cut_off.inSpace(cut_off.draw(0.0, 5.0, 0.6, 0.0, 0.6));
  EXPECT_TRUE(extentOf(cells, known(kRight), cut_off.disparity, cut_off.camera, cut_off.ground));
}

TEST(FloorBelowTest, IsHalfAMetreBelowTheLowestPoint) {
  const StereoCamera camera = test::testCamera();
  const auto floor = floorBelow({{0.0, 0.4, 9.0}, {1.0, 1.0, 10.0}}, camera);
  EXPECT_NEAR(floor.heightOf({1.0, 1.0, 10.0}), 0.5, 1e-9);
}

}  // namespace
}  // namespace headway::detect
