// SPDX-License-Identifier: BSD-3-Clause
#include "disparity_drift.h"

#include <gtest/gtest.h>

#include <random>

#include "drive.h"

namespace headway::detect {
namespace {

using test::Drive;

constexpr double kFirstDepth = 17.0;  // of the patches in the first frame [m]
constexpr double kCameraSpeed = 2.0;  // of the camera [m/s]
constexpr double kObserved_s = 0.6;   // that a point is observed
constexpr double kSpacing_m = 1.2;    // between the patches
constexpr int kPatchCount = 12, kPointsOfPatch = 5;

/// What is measured after some seconds of patches whose disparities drift, and some that move.
///
/// @param drift_px  in a second, standard deviation over the patches [px]
/// @param movers    of the patches, towards the camera at walking speed
double driftOf(double drift_px, int movers = 0) {
  Drive drive;
  DisparityDrift drift;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int frame = 0; frame < 120; ++frame) {
    std::vector<PointTrack> points;
    for (int patch = 0; patch < kPatchCount; ++patch) {
      const double creep = drift_px * std::sqrt(kObserved_s) * normal(random);
      const Eigen::Vector3d velocity(0.0, 0.0, patch < movers ? -1.3 : 0.0);
      for (int i = 0; i < kPointsOfPatch; ++i) {
        const Eigen::Vector3d place(kSpacing_m * (patch - 6) + 0.05 * i, 0.1 * (i % 2),
                                    kFirstDepth);
        PointTrack point;
        point.observations = drive.see(place, velocity, 0.2, 0.0, kCameraSpeed);
        for (Observation& one : point.observations) one.uvd.z() += creep * one.frame / 6.0;
        point.motion = fitMotion(point.observations, drive.path, drive.camera, {}, 30.0);
        points.push_back(std::move(point));
      }
    }
    drift.update(points, drive.path, drive.camera, 0.5);
  }
  return drift.at(drive.camera.fx * drive.camera.baseline_m /
                  (kFirstDepth - kCameraSpeed * kObserved_s));
}

TEST(DisparityDriftTest, IsMeasuredByStaticPatches) {
  for (const double drift_px : {0.7, 1.5, 3.0}) {
    EXPECT_NEAR(driftOf(drift_px), drift_px, 0.3 * drift_px);
  }
}

TEST(DisparityDriftTest, NoiseOfSinglePointsIsNone) { EXPECT_LT(driftOf(0.0), 0.15); }

TEST(DisparityDriftTest, WhatMovesHasLittleEffect) {
  EXPECT_LT(driftOf(0.0, kPatchCount / 3), 0.25);
  // The quantile of 0.3 is that of 0.45 among two thirds: 1.55 times as much.
  EXPECT_NEAR(driftOf(1.5, kPatchCount / 3), 1.55 * 1.5, 0.3 * 1.55 * 1.5);
}

TEST(DisparityDriftTest, IsAnErrorOfTheVelocityAlongTheLineOfSightAlone) {
  Drive drive;
  drive.see({0.0, 0.0, kFirstDepth}, Eigen::Vector3d::Zero(), 0.0);
  const Eigen::Vector3d uvd = *project({5.0, 0.0, 10.0}, drive.camera);
  const Eigen::Vector3d ray = Eigen::Vector3d(5.0, 0.0, 10.0).normalized();
  const DisparityDrift drift;
  const Eigen::Matrix3d one = drift.velocityCovariance(uvd, 1.0, drive.path, drive.camera);
  const double sigma = drift.at(uvd.z()) * 10.0 / uvd.z();
  EXPECT_NEAR(ray.dot(one * ray), sigma * sigma, 1e-9);
  EXPECT_NEAR(one.trace(), sigma * sigma, 1e-9) << "none across it";
  const auto longer = drift.velocityCovariance(uvd, 4.0, drive.path, drive.camera);
  EXPECT_NEAR(4.0 * longer.trace(), one.trace(), 1e-9) << "a random walk";
}

}  // namespace
}  // namespace headway::detect
