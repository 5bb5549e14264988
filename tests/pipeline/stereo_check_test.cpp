// SPDX-License-Identifier: BSD-3-Clause
#include "stereo_check.h"

#include <gtest/gtest.h>

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

/// The same, so many times, 0.5 s apart.
Findings findingsOf(StereoFrame frame, int count = 3) {
  StereoCheck check;
  Findings all;
  for (int i = 0; i < count; ++i) {
    frame.index = static_cast<std::size_t>(i);
    frame.time = 0.5 * i;
    for (Finding& finding : check.add(frame)) all.push_back(std::move(finding));
  }
  return all;
}

/// Expects findings of this name alone, in the second and third pair.
void expectPersistent(const Findings& findings, const char* name) {
  ASSERT_EQ(2U, findings.size());
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(name, findings[i].name);
    EXPECT_EQ(i + 1, findings[i].frame);
    EXPECT_EQ(Severity::kWarning, findings[i].severity);
  }
}

std::shared_ptr<const StereoCamera> calibrated() {
  auto camera = std::make_shared<StereoCamera>();
  camera->width = 640;
  camera->height = 400;
  camera->fx = camera->fy = 500.0;
  camera->cx = 319.5;
  camera->cy = 199.5;
  camera->baseline_m = 0.2;
  return camera;
}

TEST(StereoCheckTest, AGoodPairGivesNoWarning) {
  EXPECT_TRUE(findingsOf(pairOf(0.0)).empty());
  EXPECT_TRUE(findingsOf(pairOf(0.5)).empty()) << "within the error of a calibration";
}

TEST(StereoCheckTest, ASceneNearerThanWhatIsMatchedIsSaid) {
  const auto camera = calibrated();
  const auto findingsAt = [&](int disparity, double nearest_m) {
    const cv::Mat image = texture();
    stereo::DisparityParams matching;
    matching.nearest_m = nearest_m;
    StereoCheck check(matching);
    Findings all;
    for (int i = 0; i < 10; ++i) {
      StereoFrame frame;
      frame.index = static_cast<std::size_t>(i);
      frame.time = 0.5 * i;
      frame.camera = camera;
      frame.left = image(cv::Rect(0, 40, 640, 400)).clone();
      frame.right = image(cv::Rect(disparity, 40, 640, 400)).clone();
      for (Finding& finding : check.add(frame)) all.push_back(std::move(finding));
    }
    return all;
  };
  const double nearest_m = 1.0;  // 100 px
  EXPECT_TRUE(findingsAt(60, nearest_m).empty());
  const Findings near = findingsAt(150, nearest_m);
  ASSERT_FALSE(near.empty());
  EXPECT_EQ("too_near", near[0].name);
  EXPECT_EQ(4u, near[0].frame) << "after 2 s";
  EXPECT_NE(std::string::npos, near[0].text.find("set disparity.nearest_m to 0.6")) << near[0].text;
  EXPECT_TRUE(findingsAt(150, 0.6).empty()) << "as the text says";
}

TEST(StereoCheckTest, ACameraMovedInItsMountingIsNamedWithinASecond) {
  for (const double rows_px : {3.0, -4.0}) {
    expectPersistent(findingsOf(pairOf(rows_px)), "vertical_offset");
  }
}

TEST(StereoCheckTest, WithACalibrationItIsCorrectedAtOnceAndStillNamed) {
  const auto camera = calibrated();
  StereoFrame frame = pairOf(3.0);
  frame.camera = camera;
  StereoCheck check;
  for (int i = 0; i < 3; ++i) {
    frame.index = static_cast<std::size_t>(i);
    frame.time = 0.5 * i;
    const Findings findings = check.add(frame);
    ASSERT_EQ(1U, findings.size());
    EXPECT_EQ("vertical_offset", findings[0].name);
    EXPECT_NE(std::string::npos, findings[0].text.find("corrected")) << findings[0].text;
    EXPECT_NEAR(camera->fy * check.turn().x(), 3.0, 0.15) << i;
    EXPECT_FALSE(check.imagesContradict()) << "what is corrected is no contradiction";
  }
  frame.right = pairOf(0.2).right;
  frame.time = 2.0;
  StereoCheck exact;
  (void)exact.add(frame);
  EXPECT_TRUE(exact.turn().isZero()) << "too little to be seen";
}

TEST(StereoCheckTest, SwappedImagesAreNamed) {
  expectPersistent(findingsOf(swapped(pairOf(0.0))), "images_swapped");
}

TEST(StereoCheckTest, AnImageOfALaterTimeIsNamed) {
  const StereoFrame moved_ahead = pairOf(0.0, 1.025);
  expectPersistent(findingsOf(moved_ahead), "images_not_simultaneous");
}

TEST(StereoCheckTest, OneBadPairGivesNoWarning) { EXPECT_TRUE(findingsOf(pairOf(3.0), 1).empty()); }

TEST(StereoCheckTest, ImagesWithoutStructureGiveNoWarning) {
  StereoFrame frame;
  frame.left = cv::Mat(400, 640, CV_8U, cv::Scalar(90));
  frame.right = frame.left.clone();
  EXPECT_TRUE(findingsOf(frame).empty());
}

}  // namespace
}  // namespace headway::pipeline
