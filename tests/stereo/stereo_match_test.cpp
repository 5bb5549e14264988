// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/stereo/stereo_match.h>
#include <headway_test/textured_world.h>

namespace headway::stereo {
namespace {

/// A board in front of the camera, in parallel: one disparity everywhere.
struct Wall {
  explicit Wall(double depth) {
    test::TexturedWorld world(test::smallCamera());
    world.boards.push_back({{depth, -10.0, -10.0},
                            Eigen::Vector3d::UnitY(),
                            Eigen::Vector3d::UnitZ(),
                            20.0,
                            20.0,
                            {0.0, 0.0}});
    const auto frame = world.frame(0, 0.0, Pose::Identity());
    left = buildPyramid(frame.left, 4);
    right = buildPyramid(frame.right, 4);
    disparity = world.camera()->fx * world.camera()->baseline_m / depth;
  }
  ImagePyramid left, right;
  double disparity = 0.0;
};

TEST(StereoMatcherTest, FindsDisparitiesToATenthOfAPixel) {
  const StereoMatcher matcher(100, 0.8);
  for (const double depth : {1.3, 2.7, 6.1}) {
    const Wall wall(depth);
    int found = 0;
    int right = 0;
    for (double u = 110.0; u < 300.0; u += 12.0) {
      for (double v = 20.0; v < 220.0; v += 20.0) {
        const auto disparity = matcher.search(wall.left, wall.right, {u, v});
        if (!disparity) continue;
        ++found;
        right += std::abs(*disparity - wall.disparity) < 0.1 ? 1 : 0;
      }
    }
    EXPECT_GT(found, 60) << depth;
    EXPECT_GT(right, 0.9 * found) << depth;
  }
}

TEST(StereoMatcherTest, RefinesANearbyInitialValue) {
  const Wall wall(2.7);
  const auto disparity = StereoMatcher(100, 0.8).refine(wall.left, wall.right, {160.0, 120.0},
                                                        wall.disparity + 1.5, 0);
  ASSERT_TRUE(disparity);
  EXPECT_NEAR(*disparity, wall.disparity, 0.1);
}

TEST(StereoMatcherTest, SaysNothingWithoutTextureOrOutsideTheImage) {
  const cv::Mat flat(240, 320, CV_8U, cv::Scalar(50));
  const auto pyramid = buildPyramid(flat, 4);
  const StereoMatcher matcher(100, 0.8);
  EXPECT_FALSE(matcher.search(pyramid, pyramid, {160.0, 120.0}));
  const Wall wall(2.7);
  EXPECT_FALSE(matcher.search(wall.left, wall.right, {2.0, 120.0}));
  EXPECT_FALSE(matcher.search(wall.left, wall.right, {160.0, 239.0}));
}

TEST(StereoMatcherTest, SaysNothingOfWhatRepeats) {
  cv::Mat stripes(240, 320, CV_8U);
  for (int v = 0; v < stripes.rows; ++v) {
    for (int u = 0; u < stripes.cols; ++u) {
      stripes.at<std::uint8_t>(v, u) = (u / 8 + v / 8) % 2 == 0 ? 40 : 200;
    }
  }
  const auto pyramid = buildPyramid(stripes, 4);
  EXPECT_FALSE(StereoMatcher(100, 0.8).search(pyramid, pyramid, {200.0, 120.0}));
}

TEST(BuildPyramidTest, StopsBeforeImagesGetTiny) {
  EXPECT_EQ(buildPyramid(cv::Mat(70, 300, CV_8U, cv::Scalar(0)), 6).count(), 2);
  EXPECT_EQ(buildPyramid(cv::Mat(600, 600, CV_8U, cv::Scalar(0)), 4).count(), 4);
}

}  // namespace
}  // namespace headway::stereo
