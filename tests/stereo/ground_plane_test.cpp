// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/stereo/ground_plane.h>

#include <cmath>

namespace headway::stereo {
namespace {

StereoCamera streetCamera() {
  StereoCamera camera;
  camera.width = 620;
  camera.height = 240;
  camera.fx = camera.fy = 360.0;
  camera.cx = 309.5;
  camera.cy = 100.0;
  camera.baseline_m = 0.54;
  return camera;
}

/// Disparities of a plane below the camera, pitched, with a wall at 30 m.
DisparityImage street(const StereoCamera& camera, double height, double pitch) {
  DisparityImage image;
  image.reduce = 2;
  image.values = cv::Mat(camera.height / 2, camera.width / 2, CV_32F, cv::Scalar(0));
  const double fb = camera.fx * camera.baseline_m;
  for (int row = 0; row < image.values.rows; ++row) {
    const double y = (image.pixelOf(row) - camera.cy) / camera.fy;
    const double down = y * std::cos(pitch) + std::sin(pitch);
    const double depth = down > 0.0 ? std::min(30.0, height / down) : 30.0;
    image.values.row(row).setTo(fb / depth);
  }
  return image;
}

TEST(FindGroundTest, FindsHeightAndPitchOfTheCamera) {
  const auto camera = streetCamera();
  for (const double pitch : {-0.05, 0.0, 0.08}) {
    const auto ground = findGround(street(camera, 1.6, pitch), camera, std::nullopt);
    ASSERT_TRUE(ground);
    EXPECT_NEAR(ground->camera_height, 1.6, 0.05);
    EXPECT_NEAR(ground->up.y(), -std::cos(pitch), 0.01);
    EXPECT_NEAR(ground->up.z(), -std::sin(pitch), 0.02);
  }
}

TEST(FindGroundTest, AWallIsNoGround) {
  const auto camera = streetCamera();
  DisparityImage wall = street(camera, 1.6, 0.0);
  wall.values.setTo(camera.fx * camera.baseline_m / 10.0);
  EXPECT_FALSE(findGround(wall, camera, std::nullopt));
  wall.values.setTo(0.0F);
  EXPECT_FALSE(findGround(wall, camera, std::nullopt));
}

/// Disparities of level ground as a robot's camera sees it, `step` higher from a depth on.
DisparityImage twoLevels(const StereoCamera& camera, double height, double from, double step) {
  DisparityImage image = street(camera, height, 0.0);
  const double fb = camera.fx * camera.baseline_m;
  for (int row = 0; row < image.values.rows; ++row) {
    const double y = (image.pixelOf(row) - camera.cy) / camera.fy;
    const double beyond = y > 0.0 ? (height - step) / y : 30.0;
    if (beyond < 30.0 && beyond >= from) image.values.row(row).setTo(fb / beyond);
  }
  return image;
}

TEST(FindGroundTest, IsTheLevelThatTheRobotStandsOnNotATiltedPlaneThroughTwo) {
  auto camera = streetCamera();
  camera.T_robot_cam = Eigen::Translation3d(0.0, 0.0, 0.5) * robotFromOptical();
  for (const double step : {-0.1, 0.1}) {
    const auto ground = findGround(twoLevels(camera, 0.5, 4.0, step), camera, std::nullopt);
    ASSERT_TRUE(ground);
    EXPECT_NEAR(ground->camera_height, 0.5, 0.015) << step;
    EXPECT_NEAR(ground->up.z(), 0.0, 0.008) << step;
  }
}

TEST(FindGroundTest, IsTheRampAheadWhereThatIsAllThatIsSeen) {
  auto camera = streetCamera();
  camera.T_robot_cam = Eigen::Translation3d(0.0, 0.0, 0.5) * robotFromOptical();
  const auto ground = findGround(street(camera, 0.5, 0.1), camera, std::nullopt);
  ASSERT_TRUE(ground);
  EXPECT_NEAR(ground->up.z(), -std::sin(0.1), 0.01);
}

/// Disparities of a floor, and of a table on it, 1 to 2.5 m ahead, in a part of the columns.
DisparityImage withTable(const StereoCamera& camera, double height, double columns_ratio) {
  DisparityImage image = street(camera, height, 0.0);
  const double fb = camera.fx * camera.baseline_m;
  const int columns = static_cast<int>(columns_ratio * image.values.cols);
  const int first = (image.values.cols - columns) / 2;
  for (int row = 0; row < image.values.rows; ++row) {
    const double y = (image.pixelOf(row) - camera.cy) / camera.fy;
    const double depth = y > 0.0 ? (height - 0.7) / y : 30.0;
    const bool is_table = depth > 1.0 && depth < 2.5;
    if (is_table) image.values.row(row).colRange(first, first + columns).setTo(fb / depth);
  }
  return image;
}

TEST(FindFloorTest, ATableIsNoFloor) {
  StereoCamera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 383.0;
  camera.cx = 320.0;
  camera.cy = 240.0;
  camera.baseline_m = 0.4;
  camera.depth_reach_m = 8.0;
  int found = 0;
  for (const double height : {0.9, 1.2, 1.5}) {
    for (const double columns : {0.2, 0.5, 0.8, 0.95}) {
      const auto floor = findFloor(withTable(camera, height, columns), camera);
      if (!floor) continue;
      EXPECT_NEAR(height, floor->camera_height, 0.05) << height << " " << columns;
      ++found;
    }
  }
  EXPECT_GE(found, 6) << "where most of what is seen is floor";
}

/// The rig of a camera mounted level above the ground.
RigCapability rigAt(double height) {
  auto camera = streetCamera();
  camera.T_robot_cam = Eigen::Translation3d(0.0, 0.0, height) * robotFromOptical();
  return rigCapability(camera);
}

TEST(GroundPlaneTest, HalfOfTheLowestObstacleIsGround) {
  const auto car = groundPlane(rigAt(1.6), -Eigen::Vector3d::UnitY(), 1.6);
  EXPECT_DOUBLE_EQ(car.clearance(5.0), 0.15);
  EXPECT_TRUE(car.isGround({0.0, 1.6 - 0.14, 5.0}));
  EXPECT_FALSE(car.isGround({0.0, 1.6 - 0.16, 5.0}));
  EXPECT_TRUE(car.isGround({0.0, 1.6 + 1.0, 5.0})) << "below the plane";
  EXPECT_DOUBLE_EQ(groundPlane(rigAt(0.5), -Eigen::Vector3d::UnitY(), 0.5).clearance(5.0), 0.06);
}

TEST(GroundPlaneTest, FarGroundIsAsHighAsItsNoise) {
  const double height = 1.6;
  const auto rig = rigAt(height);
  const auto plane = groundPlane(rig, -Eigen::Vector3d::UnitY(), height);
  const double depth = 60.0;
  const double descent = height / depth;  // of the ray, per metre of depth
  EXPECT_GE(plane.heightSigma(depth), rig.depthSigma(depth) * descent);
  EXPECT_GT(plane.clearance(depth), plane.clearance_m);
  EXPECT_DOUBLE_EQ(plane.clearance(depth), 3.0 * plane.heightSigma(depth));
}

}  // namespace
}  // namespace headway::stereo
