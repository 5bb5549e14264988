// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "input_health.h"

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

TEST(CameraCheckTest, NamesImagesThatComeAgain) {
  CameraCheck check;
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(check.add(frameOf(static_cast<std::size_t>(i), 100.0, i)).empty());
  }
  for (std::size_t i = 3; i < 7; ++i) {
    const Findings findings = check.add(frameOf(i, 100.0, 2));
    ASSERT_EQ(1U, findings.size());
    EXPECT_EQ("camera_frozen", findings[0].name);
    EXPECT_EQ(i, findings[0].frame);
    EXPECT_EQ(Severity::kWarning, findings[0].severity);
    EXPECT_TRUE(check.isFrozen());
  }
  EXPECT_TRUE(check.add(frameOf(7, 100.0, 7)).empty());
  EXPECT_FALSE(check.isFrozen());
}

TEST(CameraCheckTest, NamesWhatIsWrongWithOneOfTwo) {
  CameraCheck check;
  auto frame = frameOf(0, 100.0, 0);
  (void)check.add(frame);
  const auto expectOne = [&](const char* text) {
    const Findings findings = check.add(frame);
    ASSERT_FALSE(findings.empty());
    EXPECT_EQ("one_image", findings.back().name);
    EXPECT_EQ(0U, findings.back().text.rfind(text, 0)) << findings.back().text;
    EXPECT_TRUE(check.isOneMissing());
    EXPECT_FALSE(check.isFrozen());
  };
  frame.left = frame.left.clone();
  frame.right = frameOf(1, 100.0, 1).right;
  expectOne("the left image comes again");
  frame = frameOf(2, 100.0, 2);
  frame.right = frame.left;
  expectOne("left and right image are the same");
  frame = frameOf(3, 100.0, 3);
  frame.left.setTo(0);
  expectOne("the left image shows nothing");
  EXPECT_TRUE(check.add(frameOf(4, 100.0, 4)).empty());
  EXPECT_FALSE(check.isOneMissing());
}

TEST(CameraCheckTest, ImagesWithoutStructureAreNotAFrozenCamera) {
  CameraCheck check;
  for (std::size_t i = 0; i < 3; ++i) {
    auto frame = frameOf(i, 100.0, 1);
    frame.left.setTo(40);
    frame.right.setTo(40);
    EXPECT_TRUE(check.add(frame).empty());
  }
}

TEST(CameraCheckTest, ACoveredLensIsDarkAndDuskIsNot) {
  CameraCheck check;
  EXPECT_TRUE(check.add(frameOf(0, 20.0, 0)).empty());
  auto covered = frameOf(1, 100.0, 1);
  covered.left.setTo(3);
  covered.right.setTo(4);
  const Findings findings = check.add(covered);
  ASSERT_EQ(1U, findings.size());
  EXPECT_EQ("camera_dark", findings[0].name);
}

}  // namespace
}  // namespace headway::pipeline
