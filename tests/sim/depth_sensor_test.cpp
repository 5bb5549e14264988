// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/statistics.h>
#include <headway/io/rawlog_source.h>
#include <headway/sim/recording.h>
#include <headway/sim/rigs.h>
#include <headway_test/folders.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "image_formation.h"
#include "lens.h"

namespace headway::sim {
namespace {

CameraParams depthCamera() {
  CameraParams camera;
  applyRig("rgbd", camera);
  return camera;
}

cv::Mat measured(const cv::Mat& depth, std::size_t frame = 0) {
  const CameraParams camera = depthCamera();
  return DepthSensor(camera, Lens(camera).ideal(), 7).measure(depth, frame);
}

cv::Mat wallAt(float depth_m) {
  const CameraParams camera = depthCamera();
  return {camera.height, camera.width, CV_32F, cv::Scalar(static_cast<double>(depth_m))};
}

/// Standard deviation of the measured depths of a wall [m].
double noiseAt(float depth_m) {
  cv::Mat metres;
  measured(wallAt(depth_m)).convertTo(metres, CV_64F, 1e-3);
  cv::Scalar mean, deviation;
  cv::meanStdDev(metres, mean, deviation, metres > 0.0);
  EXPECT_NEAR(static_cast<double>(depth_m), mean[0], 0.02 * deviation[0] + 1e-3);
  return deviation[0];
}

TEST(DepthSensorTest, NoiseGrowsWithTheSquareOfTheDepth) {
  for (const float depth_m : {1.0F, 2.0F, 4.0F}) {
    const double expected = 0.002 * square(static_cast<double>(depth_m));
    EXPECT_NEAR(noiseAt(depth_m), expected, 0.05 * expected) << depth_m;
  }
}

TEST(DepthSensorTest, NoiseChangesFromFrameToFrameAndIsReproducible) {
  const cv::Mat wall = wallAt(3.0F);
  EXPECT_EQ(cv::norm(measured(wall, 4), measured(wall, 4), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(measured(wall, 4), measured(wall, 5), cv::NORM_INF), 10.0);
}

TEST(DepthSensorTest, NothingIsMeasuredBeyondItsReachOrInTheSky) {
  for (const float depth_m : {0.0F, 0.3F, 9.0F, 60.0F}) {
    EXPECT_EQ(cv::countNonZero(measured(wallAt(depth_m))), 0) << depth_m;
  }
  EXPECT_EQ(cv::countNonZero(measured(wallAt(0.5F))), 848 * 480);
}

TEST(DepthSensorTest, HolesAreAtEdgesAndInTheProjectorsShadow) {
  cv::Mat depth = wallAt(4.0F);
  depth(cv::Rect(300, 100, 200, 200)).setTo(1.0F);
  const cv::Mat ranges = measured(depth);
  const cv::Mat row = ranges.row(200);
  // The projector is 0.075 m to the right: f b (1 / 1 - 1 / 4) = 24 px of shadow on the left.
  EXPECT_EQ(cv::countNonZero(row.colRange(278, 299)), 0);
  EXPECT_EQ(cv::countNonZero(row.colRange(200, 274)), 74);
  EXPECT_EQ(cv::countNonZero(row.colRange(300, 500)), 200);
  EXPECT_EQ(cv::countNonZero(row.colRange(500, 501)), 0);
  EXPECT_EQ(cv::countNonZero(row.colRange(502, 800)), 298);
  EXPECT_EQ(cv::countNonZero(ranges.col(400).rowRange(99, 100)), 0);
}

TEST(DepthRigTest, RecordsImagesWithDepthThatAgreeWithTheTruth) {
  SimParams params;
  applyRig("rgbd", params.camera);
  params.world.kind = WorldParams::Kind::kHall;
  params.recording.frames = 2;
  Simulator simulator(params);
  headway::test::TemporaryFolder folder;
  const std::string path = folder / "hall.rawlog";
  std::vector<SimFrame> frames;
  {
    Recording recording(path, params.recording, {}, simulator.camera(), simulator.recordedCamera(),
                        "");
    while (auto frame = simulator.next()) {
      recording.write(*frame);
      frames.push_back(std::move(*frame));
    }
    recording.close();
  }
  io::RawlogSource source(path, {});
  const auto read = source.next();
  ASSERT_TRUE(read && read->stereo);
  EXPECT_TRUE(frames[0].right.empty());
  EXPECT_TRUE(read->stereo->right.empty());
  EXPECT_EQ(source.camera()->depth_reach_m, 8.0);
  EXPECT_EQ(source.camera()->fx, 425.0);
  EXPECT_NEAR(source.camera()->T_robot_cam.translation().z(), 0.5, 1e-9);
  const double fb = source.camera()->fx * source.camera()->baseline_m;
  std::vector<double> errors;  // in standard deviations
  for (int v = 0; v < frames[0].depth.rows; v += 3) {
    for (int u = 0; u < frames[0].depth.cols; u += 3) {
      const auto d = static_cast<double>(read->stereo->disparity.at<float>(v, u));
      const auto z = static_cast<double>(frames[0].depth.at<float>(v, u));
      if (d > 0.0) errors.push_back(std::abs(fb / d - z) / (0.002 * z * z + 5e-4));
    }
  }
  EXPECT_GT(errors.size(), 10000U);
  EXPECT_LT(median(errors), 0.8);
}

}  // namespace
}  // namespace headway::sim
