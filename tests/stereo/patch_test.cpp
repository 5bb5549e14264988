// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/stereo/patch.h>

#include <Eigen/LU>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace headway::stereo {
namespace {

/// A smooth pattern that can be evaluated anywhere, moved, stretched and relit.
cv::Mat pattern(const Eigen::Vector2d& shift, double stretch = 1.0, double gain = 1.0,
                double offset = 0.0) {
  cv::Mat image(120, 160, CV_8U);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const double x = (u - 80.0 - shift.x()) / stretch;
      const double y = (v - 60.0 - shift.y()) / stretch;
      const double value =
          128.0 + 50.0 * std::sin(0.35 * x + 0.1 * y) + 45.0 * std::sin(0.3 * y - 0.12 * x + 1.0);
      image.at<std::uint8_t>(v, u) =
          cv::saturate_cast<std::uint8_t>(std::lround(gain * value + offset));
    }
  }
  return image;
}

const Eigen::Vector2d kCentre(80.0, 60.0);

TEST(AlignTest, FindsAShiftToAFewHundredthsOfAPixel) {
  const auto patch = cutPatch(pattern({0.0, 0.0}), kCentre);
  ASSERT_TRUE(patch);
  for (const Eigen::Vector2d& shift :
       {Eigen::Vector2d(0.3, -0.6), Eigen::Vector2d(2.4, 1.7), Eigen::Vector2d(-3.1, 0.2)}) {
    const auto found = align(*patch, pattern(shift), kCentre, AlignmentAxes::kBoth, 20);
    ASSERT_TRUE(found && found->converged);
    EXPECT_LT((found->uv - kCentre - shift).norm(), 0.04);
    EXPECT_GT(found->zncc, 0.99);
  }
}

TEST(AlignTest, IsBlindToGainAndOffsetOfBrightness) {
  const auto patch = cutPatch(pattern({0.0, 0.0}), kCentre);
  const Eigen::Vector2d shift(1.2, -0.8);
  const auto found =
      align(*patch, pattern(shift, 1.0, 0.7, 25.0), kCentre, AlignmentAxes::kBoth, 20);
  ASSERT_TRUE(found && found->converged);
  EXPECT_LT((found->uv - kCentre - shift).norm(), 0.04);
}

TEST(AlignTest, AlongTheRowKeepsTheRow) {
  const auto patch = cutPatch(pattern({0.0, 0.0}), kCentre);
  const auto found = align(*patch, pattern({1.5, 0.0}), kCentre, AlignmentAxes::kRow, 20);
  ASSERT_TRUE(found && found->converged);
  EXPECT_DOUBLE_EQ(found->uv.y(), kCentre.y());
  EXPECT_NEAR(found->uv.x(), kCentre.x() + 1.5, 0.04);
}

TEST(AlignTest, RefusesPatchesWithoutTexture) {
  const cv::Mat flat(120, 160, CV_8U, cv::Scalar(90));
  const auto patch = cutPatch(flat, kCentre);
  ASSERT_TRUE(patch);
  EXPECT_FALSE(align(*patch, flat, kCentre, AlignmentAxes::kBoth));
}

TEST(AlignTest, RefusesToLeaveTheImage) {
  const auto patch = cutPatch(pattern({0.0, 0.0}), kCentre);
  EXPECT_FALSE(align(*patch, pattern({0.0, 0.0}), {3.0, 60.0}, AlignmentAxes::kBoth));
  EXPECT_FALSE(align(*patch, pattern({0.0, 0.0}), {NAN, 60.0}, AlignmentAxes::kBoth));
}

TEST(CutPatchTest, IsEmptyAtTheBorder) {
  EXPECT_FALSE(cutPatch(pattern({0.0, 0.0}), {4.0, 60.0}));
  EXPECT_FALSE(cutPatch(pattern({0.0, 0.0}), {80.0, 118.0}));
}

TEST(WarpPatchTest, EqualsTheOtherView) {
  const auto reference = cutReference(pattern({0.0, 0.0}), {80.3, 60.8});
  const double stretch = 1.3;  // the view is nearer: one of its pixels is 1 / 1.3 of a reference's
  const auto patch = warpPatch(reference, Eigen::Matrix2d::Identity() / stretch);
  ASSERT_TRUE(patch);
  const Eigen::Vector2d where = kCentre + stretch * Eigen::Vector2d(0.3, 0.8);
  const auto found = align(*patch, pattern({0.0, 0.0}, stretch), where + Eigen::Vector2d(1.0, -1.0),
                           AlignmentAxes::kBoth, 20);
  ASSERT_TRUE(found && found->converged);
  EXPECT_LT((found->uv - where).norm(), 0.05);
  EXPECT_GT(found->zncc, 0.99);
}

TEST(WarpPatchTest, IsEmptyWhereTheReferenceEnds) {
  const auto reference = cutReference(pattern({0.0, 0.0}), kCentre);
  EXPECT_TRUE(warpPatch(reference, 1.5 * Eigen::Matrix2d::Identity()));
  EXPECT_FALSE(warpPatch(reference, 3.0 * Eigen::Matrix2d::Identity()));
  EXPECT_FALSE(warpPatch(reference, NAN * Eigen::Matrix2d::Identity()));
}

TEST(CutReferenceTest, RepeatsTheImagesEdge) {
  const cv::Mat image = pattern({0.0, 0.0});
  const auto reference = cutReference(image, {0.0, 0.0});
  EXPECT_EQ(reference.pixels[0], image.at<std::uint8_t>(0, 0));
}

}  // namespace
}  // namespace headway::stereo
