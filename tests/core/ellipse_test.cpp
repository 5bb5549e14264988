// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/ellipse.h>
#include <headway/core/pose.h>

#include <Eigen/Geometry>

namespace headway {
namespace {

TEST(EllipseTest, HasTheAxesOfARotatedCovariance) {
  for (const double angle : {-1.2, -0.3, 0.0, 0.7, 1.5}) {
    const Eigen::Matrix2d R = Eigen::Rotation2Dd(angle).toRotationMatrix();
    const Ellipse ellipse =
        sigmaEllipse(R * Eigen::Vector2d(4.0, 0.25).asDiagonal() * R.transpose());
    EXPECT_NEAR(2.0, ellipse.major, 1e-12);
    EXPECT_NEAR(0.5, ellipse.minor, 1e-12);
    EXPECT_NEAR(angle, ellipse.angle, 1e-12);
  }
}

TEST(EllipseTest, ACircleAndACertainPlaceHaveEqualAxes) {
  EXPECT_NEAR(3.0, sigmaEllipse(9.0 * Eigen::Matrix2d::Identity()).minor, 1e-12);
  EXPECT_EQ(0.0, sigmaEllipse(Eigen::Matrix2d::Zero()).major);
}

}  // namespace
}  // namespace headway
