// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "drive.h"
#include "point_follower.h"
#include "segment_follower.h"

namespace headway::detect {
namespace {

using test::Drive;

constexpr double kLastDepth = 14.0;  // of the segment in the last frame [m]

/// A segment half a metre wide with points on it, seen by a camera that drives at 5 m/s.
struct Scene {
  Drive drive;
  stereo::DisparityImage disparity;
  UprightSegment segment;
  std::vector<PointTrack> points;

  /// @param drift_px  by which all disparities of the segment creep away from the first to the last
  Scene(const Eigen::Vector3d& velocity, int count, double drift_px = 0.0) {
    disparity.reduce = 2;
    disparity.values = cv::Mat(188, 620, CV_32F, cv::Scalar(0));
    const Eigen::Vector3d now =
        Eigen::Vector3d(-0.2, 0.0, kLastDepth) + 5.0 * 0.6 * Eigen::Vector3d::UnitZ();
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d place = now + Eigen::Vector3d(0.06 * (i % 8), 0.2 * (i / 8 % 4), 0.0);
      PointTrack point;
      point.observations = drive.see(place - 0.6 * velocity, velocity, 0.4, 0.0, 5.0);
      for (auto& observation : point.observations)
        observation.uvd.z() += drift_px * observation.frame / 6.0;
      const auto& uvd = point.observations.back().uvd;
      const cv::Point cell(disparity.cellOf(uvd.x()), disparity.cellOf(uvd.y()));
      segment.cells.push_back({cell, *triangulate(uvd, drive.camera)});
      points.push_back(std::move(point));
    }
    segment.uvd = *project({0.0, 0.4, kLastDepth}, drive.camera);
  }

  [[nodiscard]] std::optional<SegmentMotion> motion(
      const std::deque<LateralSpeed>& across = {}) const {
    const Eigen::Vector3d up(0.0, -1.0, 0.0);
    return segmentMotion(segment, std::nullopt, across, points, disparity, drive.path, drive.camera,
                         up, {});
  }
};

TEST(SegmentMotionTest, WeakMeasurementsAddUp) {
  const Eigen::Vector3d away(0.0, 0.0, 1.4);
  const Scene scene(away, 24);
  int sure = 0;
  for (const auto& point : scene.points) {
    const auto motion =
        fitMotion(point.observations, scene.drive.path, scene.drive.camera, {}, 3.0);
    sure += motion->static_error - motion->moving_error > 25.0 ? 1 : 0;
  }
  EXPECT_LT(sure, 12) << "hardly a point alone";
  const auto together = scene.motion();
  ASSERT_TRUE(together);
  EXPECT_GT(together->evidence, 12.0);
  EXPECT_NEAR(together->velocity.z(), 1.4, 0.5);
  EXPECT_NEAR(together->velocity.y(), 0.0, 1e-9) << "over the ground";
}

TEST(SegmentMotionTest, AcrossTheLineOfSightItIsPlain) {
  const auto together = Scene({1.2, 0.0, 0.0}, 6).motion();
  ASSERT_TRUE(together);
  EXPECT_GT(together->evidence, 100.0);
  EXPECT_NEAR(together->velocity.x(), 1.2, 0.15);
  EXPECT_GT(together->span_s, 0.4) << "of its points' observations";
}

TEST(SegmentMotionTest, AStaticSegmentStands) {
  for (const int count : {4, 12, 40}) {
    const auto together = Scene({0.0, 0.0, 0.0}, count).motion();
    ASSERT_TRUE(together);
    EXPECT_LT(together->evidence, 9.2) << count << " parts: 1 % of still segments are beyond that";
  }
}

TEST(SegmentMotionTest, ErrorsCommonToAllPartsAreNoEvidence) {
  const auto together = Scene({0.0, 0.0, 0.0}, 60, 0.2).motion();
  ASSERT_TRUE(together);
  EXPECT_GT(together->velocity.norm(), 0.1) << "it does seem to creep";
  EXPECT_LT(together->evidence, 9.2);
}

TEST(SegmentMotionTest, AFewPartsSayNothing) { EXPECT_FALSE(Scene({1.2, 0.0, 0.0}, 2).motion()); }

TEST(SegmentMotionTest, ItsFlowAloneMeasuresItsMotionAcross) {
  Scene bare({0.0, 0.0, 0.0}, 1);
  bare.points.clear();
  const LateralSpeed flow{-1.1, 0.12, 0.1};
  EXPECT_FALSE(bare.motion({flow})) << "one may be a mismatch";
  const auto motion = bare.motion({flow, flow});
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->velocity.x(), -1.1, 0.05);
  EXPECT_NEAR(motion->across, 1.1, 0.05);
  EXPECT_GT(motion->evidence, 15.0);
  EXPECT_GT(motion->covariance(2, 2), 1.0)
      << "of what it does along the line of sight it is silent";
}

TEST(SegmentMotionTest, TheFasterTheCameraTheMoreMustASegmentMove) {
  const LateralSpeed flow{-0.3, 0.02, 0.1};
  const Eigen::Vector3d still = Eigen::Vector3d::Zero();
  double evidence[2];
  for (const double speed : {1.0, 25.0}) {
    Scene scene(still, 1);
    scene.points.clear();
    scene.drive = Drive();
    scene.drive.see({0.0, 0.0, 60.0}, still, 0.1, 0.0, speed);  // always before the camera
    evidence[speed > 1.0] = scene.motion({flow, flow, flow})->evidence;
  }
  EXPECT_GT(evidence[0], 15.0);
  EXPECT_LT(evidence[1], 15.0) << "a hundredth of the camera's speed is nearly as much";
}

TEST(SegmentMotionTest, FlowsThatContradictEachOtherAreNoEvidence) {
  Scene bare({0.0, 0.0, 0.0}, 1);
  bare.points.clear();
  const auto motion = bare.motion({{1.5, 0.1, 0.1}, {-1.2, 0.1, 0.1}, {0.4, 0.1, 0.1}});
  ASSERT_TRUE(motion);
  EXPECT_LT(motion->evidence, 9.2);
}

TEST(NoiseScaleTest, IsThatOfTheImages) {
  for (const double noise : {0.2, 0.8}) {
    Drive drive;
    std::vector<PointTrack> points(60);
    for (auto& point : points) {
      point.observations = drive.see({-3, 0, 18}, {0, 0, 0}, noise);
      point.motion = fitMotion(point.observations, drive.path, drive.camera, {}, 30.0);
    }
    NoiseScale scale;
    for (int frame = 0; frame < 30; ++frame) scale.update(points, 0.1);
    EXPECT_NEAR(scale.value(), noise / 0.4, 0.15 * noise / 0.4);
  }
}

}  // namespace
}  // namespace headway::detect
