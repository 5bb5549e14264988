// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/statistics.h>
#include <headway/stereo/disparity.h>
#include <headway_test/painted_street.h>

#include <cmath>

namespace headway::stereo {
namespace {

using test::PaintedBox;
using test::PaintedStreet;

const PaintedBox kAtTheEdge{{-9.0, 1.6, 14.0}, 3.6, 2.2, {0.0, 0.0, 0.0}, 11};

// Disparities of the cells that show the box, 0 where there is none.
std::vector<double> disparitiesOn(const PaintedBox& box, const DisparityImage& disparity,
                                  const StereoCamera& camera) {
  std::vector<double> result;
  const double px_per_m = camera.fx / box.foot.z();
  const auto right = static_cast<int>(camera.cx + px_per_m * (box.foot.x() + 0.4 * box.width));
  const auto foot = static_cast<int>(camera.cy + px_per_m * (box.foot.y() - 0.3));
  const auto head = static_cast<int>(camera.cy + px_per_m * (box.foot.y() - box.height + 0.3));
  const double nearest = camera.fx * camera.baseline_m / box.foot.z();
  for (int v = head; v < foot; v += disparity.reduce) {
    // Farther to the left the right image does not show it.
    for (int u = static_cast<int>(nearest) + 12; u < right; u += disparity.reduce) {
      result.push_back(disparity.at(u, v));
    }
  }
  return result;
}

TEST(DenseDisparityTest, ReachesAsFarLeftAsBothImagesShowAThing) {
  const PaintedStreet street({kAtTheEdge});
  const auto& camera = *street.camera();
  const auto disparity = denseDisparity(street.frame(0), DisparityParams());
  const auto values = disparitiesOn(kAtTheEdge, disparity, camera);
  ASSERT_GT(values.size(), 200u);
  const double expected = camera.fx * camera.baseline_m / kAtTheEdge.foot.z();
  int right = 0;
  for (const double d : values) right += std::abs(d - expected) < 0.7 ? 1 : 0;
  EXPECT_GT(right, 0.7 * static_cast<double>(values.size()));
}

TEST(DenseDisparityTest, NothingIsMatchedLeftOfTheRightImage) {
  const PaintedStreet street({kAtTheEdge});
  const auto disparity = denseDisparity(street.frame(0), DisparityParams());
  for (int column = 0; column < disparity.values.cols; ++column) {
    for (int row = 0; row < disparity.values.rows; ++row) {
      EXPECT_LE(disparity.values.at<float>(row, column), disparity.pixelOf(column));
    }
  }
}

}  // namespace
}  // namespace headway::stereo
