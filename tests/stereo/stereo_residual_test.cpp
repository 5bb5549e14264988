// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/stereo/stereo_residual.h>

#include <random>

namespace headway::stereo {
namespace {

constexpr double kStep = 1e-6;

StereoCamera residualCamera() {
  StereoCamera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 500.0;
  camera.fy = 510.0;
  camera.cx = 320.0;
  camera.cy = 240.0;
  camera.baseline_m = 0.3;
  return camera;
}

/// Random points in view.
std::vector<Eigen::Vector3d> points() {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> side(-3.0, 3.0), depth(2.0, 40.0);
  std::vector<Eigen::Vector3d> result;
  for (int i = 0; i < 50; ++i) result.emplace_back(side(random), side(random), depth(random));
  return result;
}

TEST(ProjectionTest, TriangulationUndoesIt) {
  for (const auto& point : points()) {
    const auto uvd = project(point, residualCamera());
    ASSERT_TRUE(uvd);
    EXPECT_TRUE(triangulate(*uvd, residualCamera())->isApprox(point, 1e-12));
    EXPECT_TRUE((point.z() * ray(uvd->head<2>(), residualCamera())).isApprox(point, 1e-12));
  }
}

TEST(ProjectionTest, HasNoResultBehindTheCameraOrWithoutDisparity) {
  EXPECT_FALSE(project({1.0, 1.0, 0.0}, residualCamera()));
  EXPECT_FALSE(project({1.0, 1.0, -2.0}, residualCamera()));
  EXPECT_FALSE(triangulate({100.0, 100.0, 0.0}, residualCamera()));
  EXPECT_FALSE(triangulate({100.0, 100.0, -1.0}, residualCamera()));
}

TEST(ProjectionJacobianTest, EqualsNumericDifferences) {
  for (const auto& point : points()) {
    const Eigen::Matrix3d analytic = projectionJacobian(point, residualCamera());
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
      const Eigen::Vector3d numeric =
          (*project(point + step, residualCamera()) - *project(point - step, residualCamera())) /
          (2.0 * kStep);
      EXPECT_LT((analytic.col(axis) - numeric).norm(), 1e-5 * (1.0 + numeric.norm()));
    }
  }
}

TEST(StereoResidualTest, JacobianByPointEqualsNumericDifferences) {
  const StereoMeasurement measurement{{300.0, 200.0}, 12.0, true, 0.7, 0.4};
  for (const auto& point : points()) {
    Eigen::Matrix3d analytic;
    static_cast<void>(stereoResidual(point, measurement, residualCamera(), &analytic));
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
      const Eigen::Vector3d numeric =
          (stereoResidual(point + step, measurement, residualCamera(), nullptr) -
           stereoResidual(point - step, measurement, residualCamera(), nullptr)) /
          (2.0 * kStep);
      EXPECT_LT((analytic.col(axis) - numeric).norm(), 1e-5 * (1.0 + numeric.norm()));
    }
  }
}

TEST(StereoResidualTest, IsZeroAtTheMeasurementAndInSigmasBesideIt) {
  const Eigen::Vector3d point(0.8, -0.6, 9.0);
  const Eigen::Vector3d uvd = *project(point, residualCamera());
  StereoMeasurement measurement{uvd.head<2>(), uvd.z(), true, 0.5, 0.25};
  EXPECT_LT(stereoResidual(point, measurement, residualCamera(), nullptr).norm(), 1e-9);
  measurement.uv -= Eigen::Vector2d(1.0, 2.0);
  measurement.disparity -= 1.0;
  const Eigen::Vector3d off = stereoResidual(point, measurement, residualCamera(), nullptr);
  EXPECT_TRUE(off.isApprox(Eigen::Vector3d(2.0, 4.0, 4.0), 1e-9));
}

TEST(StereoResidualTest, LeavesAnUnmeasuredDisparityOut) {
  const StereoMeasurement measurement{{300.0, 200.0}, 99.0, false, 0.7, 0.4};
  Eigen::Matrix3d jacobian;
  const auto residual = stereoResidual({0.8, -0.6, 9.0}, measurement, residualCamera(), &jacobian);
  EXPECT_EQ(residual.z(), 0.0);
  EXPECT_EQ(jacobian.row(2).norm(), 0.0);
}

TEST(PointByPoseTest, EqualsNumericDifferences) {
  Pose pose = Pose::Identity();
  pose.linear() = expSo3({0.05, -0.2, 0.1});
  pose.translation() << 0.4, -0.3, 0.8;
  for (const auto& point_map : points()) {
    const auto analytic = pointByPose(pose.inverse() * point_map);
    for (int axis = 0; axis < 6; ++axis) {
      const Tangent step = kStep * Tangent::Unit(axis);
      const Eigen::Vector3d numeric =
          (retract(pose, step).inverse() * point_map - retract(pose, -step).inverse() * point_map) /
          (2.0 * kStep);
      EXPECT_LT((analytic.col(axis) - numeric).norm(), 1e-6) << "axis " << axis;
    }
  }
}

}  // namespace
}  // namespace headway::stereo
