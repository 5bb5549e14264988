// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/stereo/edge_width.h>

#include <opencv2/imgproc.hpp>

namespace headway::stereo {
namespace {

/// Squares, blurred along rows, with noise.
cv::Mat squares(int blur_px, double noise_grey, double contrast = 1.0) {
  cv::Mat image(480, 640, CV_8U), noise(480, 640, CV_16S);
  cv::RNG random(3);
  for (int v = 0; v < 480; v += 24) {
    for (int u = 0; u < 640; u += 24) {
      image(cv::Rect(u, v, 24, 24) & cv::Rect(0, 0, 640, 480)) =
          128.0 + contrast * random.uniform(-70, 70);
    }
  }
  if (blur_px > 1) cv::blur(image, image, {blur_px, 1});
  random.fill(noise, cv::RNG::NORMAL, 0, noise_grey);
  cv::add(image, noise, image, cv::noArray(), CV_8U);
  return image;
}

TEST(EdgeWidthTest, StepsHaveTheWidthOfTheFilter) {
  const auto [along_rows, along_columns] = edgeWidths(squares(0, 0.0));
  EXPECT_NEAR(3.0, along_rows, 0.01);
  EXPECT_NEAR(3.0, along_columns, 0.01);
  EXPECT_EQ(0.0, edgeWidths(cv::Mat(480, 640, CV_8U, cv::Scalar(90)))[0]);
  EXPECT_EQ(0.0, edgeWidths(cv::Mat(3, 3, CV_8U, cv::Scalar(90)))[0]);
}

TEST(EdgeWidthTest, MotionWidensThemAlongItselfAloneWhateverLightAndNoise) {
  for (const double contrast : {1.0, 0.5}) {
    for (const double noise : {0.0, 1.0, 2.0}) {
      double before = 3.0;
      for (const int blur : {9, 13, 17}) {
        const auto [along_rows, along_columns] =
            edgeWidths(squares(blur, noise * contrast, contrast));
        EXPECT_GT(along_rows, 1.1 * before) << contrast << " " << noise << " " << blur;
        EXPECT_NEAR(2.7 * std::sqrt(blur), along_rows, 0.1 * along_rows);
        EXPECT_NEAR(3.0, along_columns, 0.1);
        before = along_rows;
      }
    }
  }
}

}  // namespace
}  // namespace headway::stereo
