// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/pipeline/camera_check.h>

#include <opencv2/core.hpp>

namespace headway::pipeline {
namespace {

/// Noise about a grey level.
StereoFrame frameOf(std::size_t index, double grey, int seed) {
  StereoFrame frame;
  frame.index = index;
  cv::RNG random(static_cast<std::uint64_t>(seed) + 1);
  frame.left.create(120, 160, CV_8U);
  random.fill(frame.left, cv::RNG::NORMAL, grey, 10.0);
  frame.right.create(120, 160, CV_8U);
  random.fill(frame.right, cv::RNG::NORMAL, grey, 10.0);
  return frame;
}

TEST(CameraCheckTest, CountsImagesThatComeAgain) {
  CameraCheck check;
  Warnings warnings;
  for (int i = 0; i < 3; ++i) check.add(frameOf(static_cast<std::size_t>(i), 100.0, i), warnings);
  EXPECT_TRUE(warnings.empty());
  for (std::size_t i = 3; i < 7; ++i) check.add(frameOf(i, 100.0, 2), warnings);
  ASSERT_EQ(warnings.count("camera_frozen"), 1u);
  EXPECT_EQ(warnings.at("camera_frozen").count, 4u);
  EXPECT_EQ(warnings.at("camera_frozen").first_frame, 3u);
  check.add(frameOf(7, 100.0, 7), warnings);
  EXPECT_EQ(warnings.at("camera_frozen").count, 4u);
}

TEST(CameraCheckTest, OneRepeatedImageOfTwoIsNotAFrozenCamera) {
  CameraCheck check;
  Warnings warnings;
  auto frame = frameOf(0, 100.0, 0);
  check.add(frame, warnings);
  frame.left = frame.left.clone();
  frame.right = frameOf(1, 100.0, 1).right;
  check.add(frame, warnings);
  EXPECT_TRUE(warnings.empty());
}

TEST(CameraCheckTest, ImagesWithoutStructureAreNotAFrozenCamera) {
  CameraCheck check;
  Warnings warnings;
  for (std::size_t i = 0; i < 3; ++i) {
    auto frame = frameOf(i, 100.0, 1);
    frame.left.setTo(40);
    frame.right.setTo(40);
    check.add(frame, warnings);
  }
  EXPECT_TRUE(warnings.empty());
}

TEST(CameraCheckTest, ACoveredLensIsDarkAndDuskIsNot) {
  CameraCheck check;
  Warnings warnings;
  check.add(frameOf(0, 20.0, 0), warnings);
  EXPECT_TRUE(warnings.empty());
  auto covered = frameOf(1, 100.0, 1);
  covered.left.setTo(3);
  covered.right.setTo(4);
  check.add(covered, warnings);
  EXPECT_EQ(warnings.count("camera_dark"), 1u);
}

}  // namespace
}  // namespace headway::pipeline
