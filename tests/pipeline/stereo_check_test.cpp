// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/pipeline/stereo_check.h>

#include <memory>
#include <opencv2/imgproc.hpp>

namespace headway::pipeline {
namespace {

constexpr int kDisparity = 14;

cv::Mat texture() {
  cv::Mat image(480, 800, CV_8U);
  cv::RNG random(5);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(image, image, {9, 9}, 2.0);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  return image;
}

/// A pair of a wall, the right image moved down by `rows_px` and enlarged about its centre.
StereoFrame pairOf(double rows_px, double scale = 1.0) {
  static const cv::Mat image = texture();
  StereoFrame frame;
  frame.left = image(cv::Rect(40, 40, 640, 400)).clone();
  cv::Mat moved;
  const cv::Matx23d warp(scale, 0, (1 - scale) * 360, 0, scale, (1 - scale) * 240 + rows_px);
  cv::warpAffine(image, moved, warp, image.size(), cv::INTER_LINEAR);
  frame.right = moved(cv::Rect(40 + kDisparity, 40, 640, 400)).clone();
  return frame;
}

StereoFrame swapped(StereoFrame frame) {
  std::swap(frame.left, frame.right);
  return frame;
}

/// Warnings of so many equal pairs, 0.5 s apart.
Warnings warningsOf(StereoFrame frame, int count = 3) {
  StereoCheck check;
  Warnings warnings;
  for (int i = 0; i < count; ++i) {
    frame.index = static_cast<std::size_t>(i);
    frame.time = 0.5 * i;
    check.add(frame, warnings);
  }
  return warnings;
}

TEST(StereoCheckTest, AGoodPairGivesNoWarning) {
  EXPECT_TRUE(warningsOf(pairOf(0.0)).empty());
  EXPECT_TRUE(warningsOf(pairOf(0.5)).empty()) << "within the error of a calibration";
}

TEST(StereoCheckTest, ACameraMovedInItsMountingIsNamedWithinASecond) {
  for (const double rows_px : {3.0, -4.0}) {
    const auto warnings = warningsOf(pairOf(rows_px));
    ASSERT_EQ(1u, warnings.size());
    ASSERT_EQ(1u, warnings.count("vertical_offset"));
    EXPECT_EQ(1u, warnings.at("vertical_offset").first_frame);
    EXPECT_EQ(2u, warnings.at("vertical_offset").count);
  }
}

TEST(StereoCheckTest, WithACalibrationItIsCorrectedAtOnceAndStillNamed) {
  auto camera = std::make_shared<StereoCamera>();
  camera->width = 640;
  camera->height = 400;
  camera->fx = camera->fy = 500.0;
  camera->cx = 319.5;
  camera->cy = 199.5;
  camera->baseline_m = 0.2;
  StereoFrame frame = pairOf(3.0);
  frame.camera = camera;
  StereoCheck check;
  Warnings warnings;
  for (int i = 0; i < 3; ++i) {
    frame.index = static_cast<std::size_t>(i);
    frame.time = 0.5 * i;
    check.add(frame, warnings);
    EXPECT_NEAR(camera->fy * check.turn().x(), 3.0, 0.15) << i;
    EXPECT_FALSE(check.imagesContradict()) << "what is corrected is no contradiction";
  }
  ASSERT_EQ(1u, warnings.count("vertical_offset"));
  const std::string& text = warnings.at("vertical_offset").text;
  EXPECT_NE(std::string::npos, text.find("corrected")) << text;
  frame.right = pairOf(0.2).right;
  frame.time = 2.0;
  StereoCheck exact;
  Warnings none;
  exact.add(frame, none);
  EXPECT_TRUE(exact.turn().isZero()) << "too little to be seen";
}

TEST(StereoCheckTest, SwappedImagesAreNamed) {
  const auto warnings = warningsOf(swapped(pairOf(0.0)));
  ASSERT_EQ(1u, warnings.size());
  EXPECT_EQ(1u, warnings.count("images_swapped"));
}

TEST(StereoCheckTest, AnImageOfALaterTimeIsNamed) {
  const auto warnings = warningsOf(pairOf(0.0, 1.025));  // the camera has moved ahead
  ASSERT_EQ(1u, warnings.size());
  EXPECT_EQ(1u, warnings.count("images_not_simultaneous"));
}

TEST(StereoCheckTest, OneBadPairGivesNoWarning) { EXPECT_TRUE(warningsOf(pairOf(3.0), 1).empty()); }

TEST(StereoCheckTest, ImagesWithoutStructureGiveNoWarning) {
  StereoFrame frame;
  frame.left = cv::Mat(400, 640, CV_8U, cv::Scalar(90));
  frame.right = frame.left.clone();
  EXPECT_TRUE(warningsOf(frame).empty());
}

}  // namespace
}  // namespace headway::pipeline
