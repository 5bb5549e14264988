// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/random.h>
#include <headway/core/statistics.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/frame_context.h>
#include <headway/stereo/rig_capability.h>
#include <headway/stereo/stereo_match.h>
#include <headway_test/textured_world.h>

#include <cmath>
#include <vector>

namespace headway::stereo {
namespace {

constexpr double kSigma = 0.4;  // [px]

/// Disparities of a plane that recedes to the right and upwards.
double planeAt(double u, double v) { return 40.0 - 0.05 * u + 0.1 * v; }

cv::Mat plane(double sigma = 0.0) {
  cv::Mat disparities(240, 320, CV_32F);
  Random random(5);
  for (int v = 0; v < disparities.rows; ++v) {
    for (int u = 0; u < disparities.cols; ++u) {
      disparities.at<float>(v, u) = static_cast<float>(planeAt(u, v) + sigma * random.normal());
    }
  }
  return disparities;
}

TEST(GivenDisparityTest, IsThatOfThePlaneBetweenPixels) {
  const cv::Mat disparities = plane();
  const std::vector<Eigen::Vector2d> places = {{50.0, 60.0}, {120.3, 80.7}, {200.49, 30.51}};
  for (const Eigen::Vector2d& uv : places) {
    const auto found = givenDisparity(disparities, uv);
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found, planeAt(uv.x(), uv.y()), 1e-3);
  }
}

TEST(GivenDisparityTest, HasLessNoiseThanItsPixels) {
  const cv::Mat disparities = plane(kSigma);
  double squares = 0.0;
  int count = 0;
  for (double u = 5.2; u < 310.0; u += 7.0) {
    for (double v = 5.4; v < 230.0; v += 7.0) {
      const auto found = givenDisparity(disparities, {u, v});
      if (!found) continue;
      squares += square(*found - planeAt(u, v));
      ++count;
    }
  }
  EXPECT_GT(count, 1300);
  EXPECT_LT(std::sqrt(squares / count), 0.35 * kSigma);
}

TEST(GivenDisparityTest, SaysNothingInHolesAtEdgesAndOutside) {
  cv::Mat disparities = plane();
  disparities(cv::Rect(100, 100, 6, 6)).setTo(0.0F);
  disparities.colRange(200, 320) += 12.0F;  // a nearer surface
  EXPECT_FALSE(givenDisparity(disparities, {103.0, 103.0}));
  EXPECT_FALSE(givenDisparity(disparities, {199.6, 50.0}));
  EXPECT_FALSE(givenDisparity(disparities, {200.4, 50.0}));
  EXPECT_TRUE(givenDisparity(disparities, {195.0, 50.0}));
  EXPECT_TRUE(givenDisparity(disparities, {205.0, 50.0}));
  EXPECT_FALSE(givenDisparity(disparities, {1.0, 50.0}));
  EXPECT_FALSE(givenDisparity(disparities, {-1e9, 1e9}));
  EXPECT_FALSE(givenDisparity(disparities, {318.7, 50.0}));
}

/// A board before the camera, as a depth camera sees it.
StereoFrame depthFrame() {
  test::TexturedWorld world(test::smallCamera());
  world.boards.push_back({{2.0, -10.0, -10.0},
                          Eigen::Vector3d::UnitY(),
                          Eigen::Vector3d::UnitZ(),
                          20.0,
                          20.0,
                          {0.0, 0.0}});
  StereoFrame frame = world.frame(0, 0.0, Pose::Identity());
  frame.right.release();
  frame.disparity = plane(kSigma);
  return frame;
}

TEST(DepthCameraTest, IsAskedInsteadOfMatchedWhereverADisparityIsWanted) {
  const StereoFrame frame = depthFrame();
  const FrameContext context(frame);
  const StereoMatcher matcher(10, 0.8);  // the range of the search does not limit what is given
  ASSERT_TRUE(context.right().isDepth());
  const auto searched = matcher.search(context.left(), context.right(), {160.0, 120.0});
  const auto refined = matcher.refine(context.left(), context.right(), {160.0, 120.0}, 5.0, 2);
  ASSERT_TRUE(searched && refined);
  EXPECT_NEAR(*searched, planeAt(160.0, 120.0), 3.0 * kSigma);
  EXPECT_EQ(*searched, *refined);
  EXPECT_GT(context.disparity().coverage(), 0.99);
  EXPECT_NEAR(context.disparity().at(160.0, 120.0), planeAt(160.0, 120.0), 3.0 * kSigma);
}

TEST(DepthCameraTest, DenseDisparitiesAreOfTheNearestSurfaceAndWithoutSpeckles) {
  StereoFrame frame = depthFrame();
  frame.disparity = plane();
  frame.disparity.colRange(201, 320) += 30.0F;       // a surface that begins within a cell
  frame.disparity(cv::Rect(60, 60, 4, 4)) += 30.0F;  // flying pixels
  frame.disparity(cv::Rect(100, 100, 20, 20)).setTo(0.0F);
  const DisparityImage dense = denseDisparity(frame, DisparityParams());
  ASSERT_EQ(dense.reduce, 2);
  ASSERT_EQ(dense.values.size(), cv::Size(160, 120));
  EXPECT_NEAR(dense.at(200.0, 50.0), planeAt(201.0, 50.5) + 30.0, 0.1);
  EXPECT_EQ(dense.at(61.0, 61.0), 0.0F);
  EXPECT_EQ(dense.at(110.0, 110.0), 0.0F);
  EXPECT_NEAR(dense.at(150.0, 150.0), planeAt(150.5, 150.5), 0.1);
}

TEST(DepthCameraTest, TheDisparitiesOffsetIsSubtracted) {
  const StereoFrame frame = depthFrame();
  const FrameContext context(frame, DisparityParams(), 2.0, std::nullopt);
  EXPECT_NEAR(context.disparity().at(160.0, 120.0), planeAt(160.0, 120.0) - 2.0, 3.0 * kSigma);
}

TEST(DepthCameraTest, SeesNearerThanAStereoCameraAndNoFartherThanItsReach) {
  StereoCamera camera = *depthFrame().camera;
  camera.T_robot_cam.translation().z() = 0.5;
  camera.baseline_m = 0.4;
  const auto stereo = rigCapability(camera);
  camera.depth_reach_m = 6.0;
  const auto depth = rigCapability(camera);
  EXPECT_LT(depth.nearest_m, stereo.nearest_m);
  EXPECT_GT(stereo.people_to_m, 6.0);
  for (const double reach : {depth.ground_to_m, depth.obstacles_to_m, depth.people_to_m,
                             depth.vehicles_to_m, depth.high_obstacles_to_m}) {
    EXPECT_LE(reach, 6.0);
  }
  EXPECT_NE(describe(depth).find("depth camera to 6.0 m"), std::string::npos);
}

TEST(DepthCameraTest, TheSimulatedRigSeesWhatTheDocumentSays) {
  StereoCamera camera;  // the row of doc/rigs.md
  camera.width = 848;
  camera.height = 480;
  camera.fx = camera.fy = 425.0;
  camera.cx = 423.5;
  camera.cy = 239.5;
  camera.baseline_m = 0.4 / (0.0025 * 425.0);
  camera.depth_reach_m = 8.0;
  camera.T_robot_cam =
      Eigen::AngleAxisd(10.0 * M_PI / 180.0, Eigen::Vector3d::UnitY()) * robotFromOptical();
  camera.T_robot_cam.translation().z() = 0.5;
  const auto rig = rigCapability(camera);
  EXPECT_NEAR(rig.nearest_m, 0.3, 1e-9);
  EXPECT_NEAR(rig.obstacles_from_m, 0.5, 1e-9);
  EXPECT_NEAR(rig.obstacles_to_m, 5.0, 1e-9);
  EXPECT_NEAR(rig.people_to_m, 8.0, 1e-9);
}

}  // namespace
}  // namespace headway::stereo
