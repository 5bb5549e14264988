// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "moving_object_finder.h"

namespace headway::detect {
namespace {

ObjectExtent extentAt(double x, double z, double length, double width, const Box2d& box2d) {
  ObjectExtent extent;
  extent.box.centre = {x, 0.8, z};
  extent.box.length = length;
  extent.box.width = width;
  extent.box.height = 1.6;
  extent.box.yaw = M_PI / 2;  // away from or towards the camera
  extent.box2d = box2d;
  extent.surface = extent.box.centre - Eigen::Vector3d(0.0, 0.0, 0.5 * length);
  return extent;
}

/// A car that comes, 20 m ahead; what is seen of it begins at 18 m.
MovingObject car() {
  MovingObject object;
  object.extent = extentAt(-3.0, 20.0, 4.0, 1.8, {460, 195, 540, 250});
  object.velocity.value = {0.0, 0.0, -4.0};
  return object;
}

TEST(MovingObjectTest, ItsFlankIsAPartOfItThoughTheFlanksBoxIsNot) {
  // The far end of the flank, seen at 21.5 m: its own box reaches four metres farther.
  ObjectExtent flank = extentAt(-2.5, 23.5, 4.0, 1.8, {538, 195, 556, 220});
  ASSERT_GT(flank.box.centre.z() - car().extent.box.centre.z(), 2.0 + 0.5);
  EXPECT_TRUE(isPartOf(flank, car()));
  EXPECT_TRUE(isPartOfAny(flank, {car()}));
}

TEST(MovingObjectTest, WhatWalksBesideItIsNot) {
  const ObjectExtent walker = extentAt(-5.5, 20.0, 0.7, 0.6, {400, 190, 425, 250});
  EXPECT_FALSE(isPartOf(walker, car()));
  EXPECT_FALSE(isPartOfAny(walker, {}));
}

TEST(MovingObjectTest, WhatIsSeenThroughItFarBehindIsNot) {
  const ObjectExtent behind = extentAt(-4.0, 30.0, 0.7, 0.6, {480, 200, 495, 230});
  EXPECT_FALSE(isPartOf(behind, car()));
}

TEST(MovingObjectTest, TwoWhoPassEachOtherAreTwo) {
  EXPECT_TRUE(isOpposite({1.2, 0.0, 0.1}, {-1.3, 0.0, 0.2}));
  EXPECT_FALSE(isOpposite({1.2, 0.0, 0.1}, {1.0, 0.0, -0.4}));
  EXPECT_FALSE(isOpposite({0.2, 0.0, 0.0}, {-1.3, 0.0, 0.0})) << "too slow for its direction";
  EXPECT_TRUE(isAsFast({4.0, 0.0, 0.0}, {3.5, 0.0, 0.5}));
  EXPECT_FALSE(isAsFast({4.0, 0.0, 0.0}, {2.0, 0.0, 0.0}));
}

}  // namespace
}  // namespace headway::detect
