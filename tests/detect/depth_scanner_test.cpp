// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/random.h>
#include <headway/core/statistics.h>
#include <headway/detect/depth_scanner.h>

#include <cmath>
#include <opencv2/core.hpp>

namespace headway::detect {
namespace {

constexpr float kNear = 40.0F;  // [px]
constexpr float kFar = 20.0F;

StereoFrame frameOf(int width, int height) {
  auto camera = std::make_shared<StereoCamera>();
  camera->width = width;
  camera->height = height;
  camera->fx = camera->fy = 400.0;
  camera->cx = 0.5 * width;
  camera->cy = 0.5 * height;
  camera->baseline_m = 0.5;
  StereoFrame frame;
  frame.left = cv::Mat(height, width, CV_8U, cv::Scalar(90));
  frame.camera = camera;
  return frame;
}

/// Disparities at half the size, all of one value.
stereo::DisparityImage evenDisparity(const StereoFrame& frame, float value) {
  stereo::DisparityImage disparity;
  disparity.reduce = 2;
  disparity.values = cv::Mat(frame.left.rows / 2, frame.left.cols / 2, CV_32F, cv::Scalar(value));
  return disparity;
}

DepthScan scan(const StereoFrame& frame, const stereo::DisparityImage& disparity,
               const MovingRegions& moving = {}, const stereo::DisparityImage& ground = {}) {
  return scanDepth(frame, disparity, ground, moving, stereo::rigCapability(*frame.camera));
}

/// Disparity of the ground in a row of cells [px].
double groundAt(double row) { return 16.0 + 0.2 * row; }

/// The stored disparity at a pixel of the image [px]; 0 if it is unknown.
double at(const DepthScan& scan, double u, double v) {
  const auto column = static_cast<std::size_t>((u - scan.grid.u0) / scan.grid.step_u + 0.5);
  const auto row = static_cast<std::size_t>((v - scan.grid.v0) / scan.grid.step_v + 0.5);
  const std::size_t cell = row * static_cast<std::size_t>(scan.grid.columns) + column;
  if (!scan.isKnown(cell)) return 0.0;
  std::size_t known = 0;
  for (std::size_t i = 0; i < cell; ++i) known += scan.isKnown(i) ? 1 : 0;
  return scan.disparity[known] / DepthScan::kUnitsPerPx;
}

TEST(DepthScannerTest, TakesDepthsWithinReachAndTheirColours) {
  const auto frame = frameOf(320, 240);
  const auto seen = scan(frame, evenDisparity(frame, kNear));
  EXPECT_EQ(seen.grid.cells(), seen.disparity.size());
  EXPECT_EQ(90, seen.colour.front());
  EXPECT_DOUBLE_EQ(kNear, at(seen, 160, 120));
  const auto rig = stereo::rigCapability(*frame.camera);
  const auto beyond = static_cast<float>(0.9 * rig.focal_baseline / rig.dense_to_m);
  EXPECT_TRUE(scan(frame, evenDisparity(frame, beyond)).empty());
}

TEST(DepthScannerTest, LeavesOutMovingAndPossiblyMovingObjects) {
  const auto frame = frameOf(320, 240);
  MovingRegions moving;
  moving.boxes.push_back({40, 40, 80, 80});
  moving.unsure.push_back({200, 100, 240, 160});
  const auto seen = scan(frame, evenDisparity(frame, kNear), moving);
  EXPECT_EQ(0.0, at(seen, 60, 60));
  EXPECT_EQ(0.0, at(seen, 220, 130));
  EXPECT_DOUBLE_EQ(kNear, at(seen, 140, 60));
}

TEST(DepthScannerTest, KeepsWhatIsBehindAMovingObject) {
  const auto frame = frameOf(320, 240);
  auto disparity = evenDisparity(frame, kFar);
  disparity.values.colRange(20, 40).setTo(kNear);  // pixels 40 to 80
  MovingRegions moving;
  moving.boxes.push_back({{40, 40, 240, 200}, 7.0});  // depths of 5 m, and 10 m behind
  const auto seen = scan(frame, disparity, moving);
  EXPECT_EQ(0.0, at(seen, 60, 120)) << "the object";
  EXPECT_EQ(0.0, at(seen, 82, 120)) << "its border";
  EXPECT_DOUBLE_EQ(kFar, at(seen, 160, 120)) << "in its box, behind it";
  moving.boxes.front().to_m = 12.0;
  EXPECT_EQ(0.0, at(scan(frame, disparity, moving), 160, 120));
}

TEST(DepthScannerTest, LeavesOutTheBorderOfWhatStandsBeforeSomethingFarther) {
  const auto frame = frameOf(320, 240);
  auto disparity = evenDisparity(frame, kFar);
  disparity.values.colRange(60, 100).setTo(kNear);  // pixels 120 to 200
  const auto seen = scan(frame, disparity);
  EXPECT_EQ(0.0, at(seen, 122, 120));
  EXPECT_EQ(0.0, at(seen, 198, 120));
  EXPECT_DOUBLE_EQ(kNear, at(seen, 160, 120));
  EXPECT_DOUBLE_EQ(kFar, at(seen, 110, 120)) << "the background has no border";
}

/// Disparities of a ground plane in a share of the cells, with noise.
stereo::DisparityImage sparseGround(const StereoFrame& frame, double known_ratio, double noise_px) {
  auto disparity = evenDisparity(frame, 0.0F);
  Random random(5);
  for (int row = 0; row < disparity.values.rows; ++row) {
    for (int column = 0; column < disparity.values.cols; ++column) {
      if (!random.chance(known_ratio)) continue;
      disparity.values.at<float>(row, column) =
          static_cast<float>(groundAt(row) + noise_px * random.normal());
    }
  }
  return disparity;
}

TEST(DepthScannerTest, TakesTheGroundWhereItAgreesAndWhereNothingElseIsKnown) {
  const auto frame = frameOf(320, 240);
  auto disparity = evenDisparity(frame, kFar);
  disparity.values.colRange(0, 40).setTo(0.0F);      // pixels 0 to 80
  disparity.values.colRange(120, 160).setTo(kNear);  // pixels 240 to 320: an obstacle
  const auto ground = evenDisparity(frame, kFar + 1.5F);
  const auto seen = scan(frame, disparity, {}, ground);
  EXPECT_NEAR(kFar + 1.5F, at(seen, 40, 120), 0.1);
  EXPECT_NEAR(kFar + 1.5F, at(seen, 160, 120), 0.1);
  EXPECT_NEAR(kNear, at(seen, 280, 120), 0.1);
}

TEST(DepthScannerTest, LeavesOutMovingObjectsOnTheGround) {
  const auto frame = frameOf(320, 240);
  MovingRegions moving;
  moving.boxes.push_back({40, 40, 80, 80});
  const auto seen = scan(frame, evenDisparity(frame, 0.0F), moving, evenDisparity(frame, kFar));
  EXPECT_EQ(0.0, at(seen, 60, 60));
  EXPECT_NEAR(kFar, at(seen, 160, 120), 0.1);
}

TEST(DepthScannerTest, CompletesAndSmoothsPlainSurfaces) {
  const auto frame = frameOf(320, 240);
  const auto seen = scan(frame, sparseGround(frame, 0.25, 0.4));
  std::size_t known = 0;
  double squares = 0.0;
  for (int v = 20; v < 220; v += 10) {
    for (int u = 20; u < 300; u += 10) {
      const double value = at(seen, u, v);
      if (value <= 0.0) continue;
      ++known;
      const double row = std::floor((v - seen.grid.v0) / seen.grid.step_v + 0.5);
      squares += square(value - groundAt((seen.grid.v0 + row * seen.grid.step_v - 0.5) / 2.0));
    }
  }
  EXPECT_GT(known, 0.98 * 20 * 28);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(known)), 0.1);
}

TEST(DepthScannerTest, CompletesNothingOutsideOfWhatWasMatched) {
  const auto frame = frameOf(320, 240);
  auto disparity = sparseGround(frame, 0.25, 0.0);
  disparity.values.colRange(80, 160).setTo(0.0F);
  const auto seen = scan(frame, disparity);
  EXPECT_GT(at(seen, 120, 120), 0.0);
  for (int v = 10; v < 230; v += 10) EXPECT_EQ(0.0, at(seen, 180, v)) << v;
}

TEST(DepthScannerTest, KeepsWhatStandsOnAPlainSurface) {
  const auto frame = frameOf(320, 240);
  auto disparity = sparseGround(frame, 0.6, 0.0);
  disparity.values(cv::Rect(70, 40, 16, 30)).setTo(60.0F);  // pixels 140 to 172, 80 to 140
  const auto seen = scan(frame, disparity);
  EXPECT_NEAR(60.0, at(seen, 156, 110), 0.1);
  for (int v = 90; v < 135; v += 4) {
    for (int u = 120; u < 190; u += 4) {
      const double value = at(seen, u, v);
      const bool is_ground = std::abs(value - groundAt((v - 0.5) / 2.0)) < 1.5;
      EXPECT_TRUE(value == 0.0 || is_ground || std::abs(value - 60.0) < 1.5) << value;
    }
  }
}

}  // namespace
}  // namespace headway::detect
