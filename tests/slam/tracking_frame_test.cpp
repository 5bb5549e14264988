// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/stereo/patch.h>

#include <opencv2/core.hpp>

#include "landmark_tracker.h"
#include "test_camera.h"

namespace headway::slam {
namespace {

/// Cells of a frame with a moving region over the left part of the image.
int cellsBesideRegion(double covered_ratio, const SlamParams& params) {
  const auto camera = std::make_shared<const StereoCamera>(testCamera());
  StereoFrame frame;
  frame.camera = camera;
  frame.left = frame.right = cv::Mat(camera->height, camera->width, CV_8UC1, cv::Scalar(90));
  MovingRegions moving;
  moving.mask = cv::Mat::zeros(camera->height, camera->width, CV_8UC1);
  moving.mask.colRange(0, static_cast<int>(covered_ratio * camera->width)).setTo(255);
  return makeTrackingFrame(stereo::FrameContext(frame), moving, *camera, params).grid.count();
}

TEST(TrackingFrameTest, CellsOutsideOfMovingRegionsStayAboutAsMany) {
  const SlamParams params;
  const int whole = cellsBesideRegion(0.0, params);
  EXPECT_NEAR(whole, params.features, 0.1 * params.features);
  EXPECT_EQ(cellsBesideRegion(0.1, params), whole);
  EXPECT_NEAR(cellsBesideRegion(0.5, params), 2 * whole, 0.2 * whole);
}

TEST(TrackingFrameTest, CellsAreNeverSmallerThanPatches) {
  const SlamParams params;
  const int smallest =
      testCamera().width * testCamera().height / (stereo::kPatchSize * stereo::kPatchSize);
  EXPECT_LE(cellsBesideRegion(0.99, params), 1.1 * smallest);
  EXPECT_LE(cellsBesideRegion(1.0, params), 1.1 * smallest);
}

TEST(TrackingFrameTest, ARegionThatIsIgnoredKeepsTheCells) {
  SlamParams params;
  params.dynamic_rejection = DynamicRejection::kNone;
  EXPECT_EQ(cellsBesideRegion(0.5, params), cellsBesideRegion(0.0, params));
}

}  // namespace
}  // namespace headway::slam
