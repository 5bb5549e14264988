// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/error.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "landmark_tracker.h"

namespace headway::slam {
namespace {

const cv::Size kImage(100, 60);

TEST(ExcludedMaskTest, HoldsTheBoxesAndNothingElse) {
  MovingRegions moving;
  moving.boxes.push_back({10.0, 5.0, 29.0, 14.0});
  const cv::Mat mask = excludedMask(moving, DynamicRejection::kBoxes, kImage);
  EXPECT_EQ(cv::countNonZero(mask), 20 * 10);
  EXPECT_NE(mask.at<std::uint8_t>(5, 10), 0);
  EXPECT_NE(mask.at<std::uint8_t>(14, 29), 0);
}

TEST(ExcludedMaskTest, AddsBoxesToTheMask) {
  MovingRegions moving;
  moving.mask = cv::Mat(kImage, CV_8UC1, cv::Scalar(0));
  moving.mask(cv::Rect(80, 40, 5, 5)).setTo(1);
  moving.boxes.push_back({0.0, 0.0, 1.0, 1.0});
  EXPECT_EQ(cv::countNonZero(excludedMask(moving, DynamicRejection::kBoth, kImage)), 25 + 4);
  EXPECT_EQ(cv::countNonZero(moving.mask), 25);
}

TEST(ExcludedMaskTest, IsEmptyWhereNothingIsToBeExcluded) {
  MovingRegions moving;
  EXPECT_TRUE(excludedMask(moving, DynamicRejection::kBoth, kImage).empty());
  moving.boxes.push_back({0.0, 0.0, 50.0, 50.0});
  EXPECT_TRUE(excludedMask(moving, DynamicRejection::kNone, kImage).empty());
  EXPECT_TRUE(excludedMask(moving, DynamicRejection::kGeometric, kImage).empty());
}

TEST(ExcludedMaskTest, HoldsWhatIsUnsureOnlyWhereNothingElseDecides) {
  MovingRegions moving;
  moving.unsure.push_back({10.0, 5.0, 29.0, 14.0});
  EXPECT_EQ(cv::countNonZero(excludedMask(moving, DynamicRejection::kBoxes, kImage)), 20 * 10);
  EXPECT_TRUE(excludedMask(moving, DynamicRejection::kBoth, kImage).empty());
  EXPECT_EQ(cv::countNonZero(suspectMask(moving, DynamicRejection::kBoth, kImage)), 20 * 10);
  EXPECT_TRUE(suspectMask(moving, DynamicRejection::kBoxes, kImage).empty());
}

TEST(ExcludedMaskTest, TakesBoxesThatLeaveTheImageOrAreNoBoxes) {
  MovingRegions moving;
  const double inf = std::numeric_limits<double>::infinity();
  moving.boxes.push_back({-1e9, -1e9, 1e9, 4.0});
  moving.boxes.push_back({NAN, 0.0, 10.0, 10.0});
  moving.boxes.push_back({-inf, -inf, inf, inf});
  moving.boxes.push_back({200.0, 10.0, 300.0, 20.0});
  moving.boxes.push_back({50.0, 30.0, 40.0, 20.0});
  EXPECT_EQ(cv::countNonZero(excludedMask(moving, DynamicRejection::kBoxes, kImage)), 100 * 5);
}

TEST(ExcludedMaskTest, RefusesAMaskOfAnotherSize) {
  MovingRegions moving;
  moving.mask = cv::Mat(10, 10, CV_8UC1, cv::Scalar(0));
  EXPECT_THROW(static_cast<void>(excludedMask(moving, DynamicRejection::kBoth, kImage)),
               InputError);
}

}  // namespace
}  // namespace headway::slam
