// SPDX-License-Identifier: BSD-3-Clause
#include "keypoints.h"

#include <gtest/gtest.h>
#include <headway_test/textured_world.h>

#include <set>

namespace headway::slam {
namespace {

cv::Mat textured() {
  test::TexturedWorld world(test::smallCamera());
  world.addRoom(8.0, 6.0, 4.0);
  return world.frame(0, 0.0, Pose::Identity()).left;
}

TEST(DetectKeypointsTest, GivesAtMostOneACell) {
  const cv::Mat image = textured();
  const FeatureGrid grid(image.cols, image.rows, 200);
  const auto keypoints =
      detectKeypoints(image, grid, std::vector<bool>(grid.count(), false), cv::Mat());
  std::set<int> cells;
  for (const Keypoint& keypoint : keypoints) {
    EXPECT_TRUE(cells.insert(grid.cellOf(keypoint.uv)).second);
  }
  EXPECT_GT(keypoints.size(), 100U);
}

TEST(DetectKeypointsTest, LeavesOccupiedCellsAndExcludedPixelsAlone) {
  const cv::Mat image = textured();
  const FeatureGrid grid(image.cols, image.rows, 200);
  std::vector<bool> occupied(grid.count(), false);
  for (int cell = 0; cell < grid.count(); cell += 2) occupied[cell] = true;
  cv::Mat excluded(image.size(), CV_8U, cv::Scalar(0));
  excluded(cv::Rect(100, 50, 80, 90)).setTo(255);
  for (const Keypoint& keypoint : detectKeypoints(image, grid, occupied, excluded)) {
    EXPECT_FALSE(occupied[grid.cellOf(keypoint.uv)]);
    EXPECT_FALSE(
        cv::Rect(100, 50, 80, 90)
            .contains({static_cast<int>(keypoint.uv.x()), static_cast<int>(keypoint.uv.y())}));
  }
}

TEST(DetectKeypointsTest, FindsNothingWhereThereIsNothing) {
  const cv::Mat image(240, 320, CV_8U, cv::Scalar(77));
  const FeatureGrid grid(image.cols, image.rows, 200);
  EXPECT_TRUE(
      detectKeypoints(image, grid, std::vector<bool>(grid.count(), false), cv::Mat()).empty());
}

TEST(FeatureGridTest, CellsCoverTheImageOnce) {
  const FeatureGrid grid(321, 243, 150);
  int pixels = 0;
  for (int cell = 0; cell < grid.count(); ++cell) {
    const cv::Rect area = grid.pixelsOf(cell);
    pixels += area.area();
    EXPECT_EQ(grid.cellOf({area.x + 0.0, area.y + 0.0}), cell);
  }
  EXPECT_EQ(pixels, 321 * 243);
}

}  // namespace
}  // namespace headway::slam
