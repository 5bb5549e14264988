// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/statistics.h>
#include <headway/stereo/frame_context.h>
#include <headway/stereo/ground_plane.h>
#include <headway_test/painted_street.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace headway::stereo {
namespace {

using test::PaintedBox;
using test::PaintedStreet;

constexpr double kReach_m = 20.0;
constexpr double kHeight_m = 1.6;  // of the camera in a painted street

GroundPlane streetGround(const StereoCamera& camera) {
  return groundPlane(rigCapability(camera), -Eigen::Vector3d::UnitY(), kHeight_m);
}

struct Matched {
  double known_ratio = 0.0;
  double rms_px = 0.0;  ///< of the known cells
};

/// Disparities of the lane before the camera against those of flat ground.
Matched compareLane(const DisparityImage& disparity, const StereoCamera& camera) {
  Matched result;
  double squares = 0.0;
  int cells = 0, known = 0;
  const double nearest = camera.fx * kHeight_m / (camera.height - 1.0 - camera.cy);
  for (double depth = 1.2 * nearest; depth < 0.8 * kReach_m; depth *= 1.02) {
    const double v = camera.cy + camera.fy * kHeight_m / depth;
    for (double x = -1.0; x <= 1.0; x += 0.1) {
      const double value = static_cast<double>(disparity.at(camera.cx + camera.fx * x / depth, v));
      ++cells;
      if (value <= 0.0) continue;
      ++known;
      const double row = disparity.pixelOf(disparity.cellOf(v));
      squares += square(value - camera.baseline_m / kHeight_m * (row - camera.cy));
    }
  }
  result.known_ratio = known / static_cast<double>(cells);
  result.rms_px = std::sqrt(squares / std::max(1, known));
  return result;
}

TEST(GroundDisparityTest, GivesMoreOfTheGroundAndMoreExactlyThanSquareBlocks) {
  const PaintedStreet street({});
  const auto& camera = *street.camera();
  const auto frame = street.frame(0);
  const auto blocks = compareLane(denseDisparity(frame, DisparityParams()), camera);
  const auto ground = compareLane(
      groundDisparity(frame, streetGround(camera), DisparityParams(), kReach_m), camera);
  EXPECT_GT(ground.known_ratio, 0.9);
  EXPECT_GT(ground.known_ratio, blocks.known_ratio + 0.1);
  EXPECT_LT(ground.rms_px, 0.3);
  EXPECT_LT(ground.rms_px, 0.5 * blocks.rms_px);
}

TEST(GroundDisparityTest, LeavesOutWhatStandsOnTheGroundAndWhatIsBeyondReach) {
  const PaintedBox box{{0.0, kHeight_m, 9.0}, 4.0, 1.4, {0.0, 0.0, 0.0}, 11};
  const PaintedStreet street({box});
  const auto& camera = *street.camera();
  const auto disparity =
      groundDisparity(street.frame(0), streetGround(camera), DisparityParams(), kReach_m);
  int cells = 0, known = 0;
  for (double y = 0.5; y < 1.3; y += 0.05) {
    for (double x = -1.7; x < 1.7; x += 0.05) {
      const double u = camera.cx + camera.fx * x / box.foot.z();
      const double v = camera.cy + camera.fy * (kHeight_m - y) / box.foot.z();
      ++cells;
      known += disparity.at(u, v) > 0.0F ? 1 : 0;
    }
  }
  EXPECT_LT(known, 0.02 * cells);
  const auto least = static_cast<float>(camera.fx * camera.baseline_m / kReach_m);
  EXPECT_EQ(0, cv::countNonZero((disparity.values > 0.0F) & (disparity.values < 0.999F * least)));
}

TEST(GroundDisparityTest, HasNoneForADepthCamerasFrameOrGroundOutOfView) {
  const PaintedStreet street({});
  const auto plane = streetGround(*street.camera());
  auto frame = street.frame(0);
  GroundPlane beside = plane;
  beside.up = Eigen::Vector3d::UnitX();
  EXPECT_EQ(0.0, groundDisparity(frame, beside, DisparityParams(), kReach_m).coverage());
  frame.disparity = cv::Mat(frame.left.size(), CV_32F, cv::Scalar(20.0));
  EXPECT_EQ(0.0, groundDisparity(frame, plane, DisparityParams(), kReach_m).coverage());
}

TEST(GroundDisparityTest, AContextSubtractsTheOffsetOfTheDisparities) {
  const PaintedStreet street({});
  const auto frame = street.frame(0);
  const auto matched = [&](double offset_px) {
    const FrameContext context(frame, DisparityParams(), offset_px, std::nullopt);
    const auto match = context.groundMatching(kReach_m);
    return match ? match() : DisparityImage();
  };
  const auto exact = matched(0.0), shifted = matched(0.5);
  ASSERT_FALSE(exact.empty());
  ASSERT_FALSE(shifted.empty());
  const cv::Mat both = (exact.values > 0.0F) & (shifted.values > 0.0F);
  ASSERT_GT(cv::countNonZero(both), 1000);
  EXPECT_NEAR(0.5, cv::mean(exact.values - shifted.values, both)[0], 0.1);
}

TEST(GroundDisparityTest, AContextWithoutGroundHasNothingToMatch) {
  const PaintedStreet street({});
  auto frame = street.frame(0);
  frame.left.setTo(90);
  frame.right.setTo(90);
  EXPECT_FALSE(FrameContext(frame).groundMatching(kReach_m));
}

}  // namespace
}  // namespace headway::stereo
