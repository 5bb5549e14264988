// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "grid.h"
#include "point_follower.h"

namespace headway::detect {
namespace {

TEST(InterestPointsTest, PreferPeopleWithinTheRangeGiven) {
  test::Grid grid;
  cv::Mat image(376, 1240, CV_8U);
  cv::RNG random(5);
  random.fill(image, cv::RNG::UNIFORM, 0, 255);
  const int middle = grid.disparity.values.cols / 2;
  const auto disparityAt = [&](double depth) {
    return static_cast<float>(grid.camera.fx * grid.camera.baseline_m / depth);
  };
  grid.disparity.values.colRange(0, middle).setTo(disparityAt(8.0));
  grid.disparity.values.colRange(middle, grid.disparity.values.cols).setTo(disparityAt(12.0));
  const auto nearRatio = [&](double people_m) {
    const auto points = interestPoints(image, grid.disparity, grid.camera, std::nullopt,
                                       {50.0, 3.5, people_m}, {}, 8, 300);
    EXPECT_GT(points.size(), 200u);
    const auto near = std::count_if(points.begin(), points.end(), [&](const cv::Point2f& point) {
      return grid.disparity.cellOf(point.x) < middle;
    });
    return static_cast<double>(near) / static_cast<double>(points.size());
  };
  EXPECT_NEAR(nearRatio(28.0), 0.5, 0.15) << "both halves are within the range";
  EXPECT_GT(nearRatio(10.0), 0.9);
}

}  // namespace
}  // namespace headway::detect
