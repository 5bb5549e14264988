// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/mrpt_pose.h>
#include <headway/map/map_export.h>

namespace headway::map {
namespace {

Pose examplePose() {
  Pose pose = Pose::Identity();
  pose.translation() << 3.0, -2.0, 1.0;
  pose.linear() = expSo3({0.3, -0.4, 1.1});
  return pose;
}

/// (x, y, z, yaw, pitch, roll) of a pose.
Eigen::Matrix<double, 6, 1> coordinatesOf(const Pose& pose) {
  const auto p = toMrpt(pose);
  Eigen::Matrix<double, 6, 1> coordinates;
  coordinates << p.x(), p.y(), p.z(), p.yaw(), p.pitch(), p.roll();
  return coordinates;
}

TEST(MrptPoseTest, ConvertsThereAndBack) {
  EXPECT_TRUE(fromMrpt(toMrpt(examplePose())).isApprox(examplePose(), 1e-12));
}

TEST(MrptPoseTest, TransformsPointsAlike) {
  const Eigen::Vector3d point(0.5, 2.0, -1.0);
  const auto composed = toMrpt(examplePose()).composePoint(mrpt::math::TPoint3D(0.5, 2.0, -1.0));
  const Eigen::Vector3d ours = examplePose() * point;
  EXPECT_NEAR(composed.x, ours.x(), 1e-12);
  EXPECT_NEAR(composed.y, ours.y(), 1e-12);
  EXPECT_NEAR(composed.z, ours.z(), 1e-12);
}

TEST(ToMrptPdfTest, MapsCovarianceAsNumericDifferentiationDoes) {
  Eigen::Matrix<double, 6, 6> root = Eigen::Matrix<double, 6, 6>::Identity();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) root(i, j) += 0.1 * std::sin(3.0 * i + j);
  }
  const PoseCovariance covariance = 1e-4 * root * root.transpose();

  Eigen::Matrix<double, 6, 6> numeric;
  const double step = 1e-6;
  for (int i = 0; i < 6; ++i) {
    const auto perturbed = [&](double amount) {
      Eigen::Matrix<double, 6, 1> xi = Eigen::Matrix<double, 6, 1>::Zero();
      xi[i] = amount;
      Pose delta = Pose::Identity();
      delta.translation() = xi.head<3>();
      delta.linear() = expSo3(xi.tail<3>());
      return coordinatesOf(examplePose() * delta);
    };
    numeric.col(i) = (perturbed(step) - perturbed(-step)) / (2.0 * step);
  }
  const PoseCovariance expected = numeric * covariance * numeric.transpose();

  const auto pdf = toMrptPdf(examplePose(), covariance);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) EXPECT_NEAR(pdf.cov(i, j), expected(i, j), 1e-9) << i << ' ' << j;
  }
}

TEST(ToMrptPdfTest, IsFiniteForAVerticalPitch) {
  Pose pose = Pose::Identity();
  pose.linear() = expSo3({0.0, -1.5707963267948966, 0.0});
  const auto pdf = toMrptPdf(pose, PoseCovariance::Identity());
  for (int i = 0; i < 6; ++i) EXPECT_TRUE(std::isfinite(pdf.cov(i, i)));
}

}  // namespace
}  // namespace headway::map
