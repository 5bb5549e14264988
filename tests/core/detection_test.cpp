#include <gtest/gtest.h>
#include <headway/core/detection.h>

#include <cmath>
#include <limits>

namespace headway {
namespace {

TEST(OpticalBox, ofAnObjectAheadThatDrivesAway) {
  const Box3d box =
      opticalBox({10.0, 2.0, 0.5}, {4.0, 1.8, 1.5}, 0.0, robotFromOptical().inverse());
  EXPECT_TRUE(box.centre.isApprox(Eigen::Vector3d(-2.0, -0.5, 10.0), 1e-12));
  EXPECT_DOUBLE_EQ(box.length, 4.0);
  EXPECT_DOUBLE_EQ(box.width, 1.8);
  EXPECT_DOUBLE_EQ(box.height, 1.5);
  EXPECT_NEAR(box.yaw, -M_PI / 2.0, 1e-12);  // KITTI: along the camera's view
}

TEST(OpticalBox, itsFrontIsTheObjectsFront) {
  const double yaw = 0.7;
  const Pose T_optical_map = robotFromOptical().inverse();
  const Box3d box = opticalBox({10.0, 2.0, 0.5}, {4.0, 1.8, 1.5}, yaw, T_optical_map);
  const Eigen::Vector3d front = T_optical_map.linear().inverse() * frontOf(box);
  EXPECT_TRUE(front.isApprox(Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0), 1e-12));
}

TEST(IsFinite, asksEveryNumberOfABox) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(isFinite(Box2d{1.0, 2.0, 3.0, 4.0}));
  EXPECT_FALSE(isFinite(Box2d{1.0, nan, 3.0, 4.0}));
  EXPECT_FALSE(isFinite(Box2d{1.0, 2.0, -infinite, infinite}));
  const Box3d box{{0.0, 0.0, 5.0}, 4.0, 2.0, 1.5, 0.1};
  EXPECT_TRUE(isFinite(box));
  for (double Box3d::*number : {&Box3d::length, &Box3d::width, &Box3d::height, &Box3d::yaw}) {
    Box3d broken = box;
    broken.*number = nan;
    EXPECT_FALSE(isFinite(broken));
  }
  Box3d nowhere = box;
  nowhere.centre.y() = infinite;
  EXPECT_FALSE(isFinite(nowhere));
}

}  // namespace
}  // namespace headway
