// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/stereo/image_pyramid.h>

#include <opencv2/core.hpp>

namespace headway::stereo {
namespace {

double deviationOf(const cv::Mat& image) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  return deviation[0];
}

TEST(ContrastStretchTest, LeavesAnImageInGoodLightAsItIs) {
  cv::Mat image(50, 50, CV_8U);
  cv::randu(image, 0, 256);
  EXPECT_EQ(stretched(image, stretchFor(image)).data, image.data);
}

TEST(ContrastStretchTest, GivesADarkImageTheContrastOfGoodLight) {
  cv::Mat image(50, 50, CV_8U);
  cv::randu(image, 20, 60);
  const double before = deviationOf(image);
  ASSERT_LT(before, 15.0);
  EXPECT_NEAR(deviationOf(stretched(image, stretchFor(image))), 40.0, 1.0);
}

TEST(ContrastStretchTest, MakesNothingOutOfNothing) {
  const cv::Mat black(50, 50, CV_8U, cv::Scalar(3));
  EXPECT_EQ(deviationOf(stretched(black, stretchFor(black))), 0.0);
}

}  // namespace
}  // namespace headway::stereo
