// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/mrpt_pose.h>
#include <headway/core/pose.h>

#include <cmath>
#include <random>
#include <vector>

namespace headway {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Rotation vectors of many directions with angles from 1e-14 to just below pi.
std::vector<Vector3d> rotationVectors() {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Vector3d> vectors{Vector3d::Zero()};
  for (const double angle : {1e-14, 1e-9, 1e-4, 0.1, 1.0, 2.5, 3.1, M_PI - 1e-6}) {
    for (int i = 0; i < 5; ++i) {
      const Vector3d axis(normal(random), normal(random), normal(random));
      vectors.push_back(angle * axis.normalized());
    }
  }
  return vectors;
}

Pose somePose(double seed) {
  Pose pose = Pose::Identity();
  pose.linear() = expSo3({0.3 * seed, -0.7, 0.2 + seed});
  pose.translation() = Vector3d(1.0 + seed, -2.0, 0.5 * seed);
  return pose;
}

TEST(CrossMatrixTest, MultipliesAsTheCrossProduct) {
  const Vector3d v(0.3, -1.2, 2.0);
  const Vector3d w(-0.7, 0.1, 0.4);
  EXPECT_TRUE((crossMatrix(v) * w).isApprox(v.cross(w), 1e-15));
  EXPECT_TRUE(crossMatrix(v).transpose().isApprox(-crossMatrix(v)));
}

TEST(ExpSo3Test, GivesRotations) {
  for (const Vector3d& omega : rotationVectors()) {
    const Matrix3d rotation = expSo3(omega);
    EXPECT_TRUE((rotation * rotation.transpose()).isIdentity(1e-14)) << omega.transpose();
    EXPECT_NEAR(1.0, rotation.determinant(), 1e-14);
  }
}

TEST(ExpSo3Test, KeepsItsAxisAndRotatesByItsAngle) {
  for (const Vector3d& omega : rotationVectors()) {
    const Matrix3d rotation = expSo3(omega);
    EXPECT_TRUE((rotation * omega - omega).isZero(1e-14)) << omega.transpose();
    EXPECT_NEAR(1.0 + 2.0 * std::cos(omega.norm()), rotation.trace(), 1e-13);
  }
}

TEST(ExpSo3Test, OfTheNegativeIsTheInverse) {
  for (const Vector3d& omega : rotationVectors()) {
    EXPECT_TRUE((expSo3(omega) * expSo3(-omega)).isIdentity(1e-14)) << omega.transpose();
  }
}

TEST(ExpSo3Test, DerivativeAtZeroIsTheCrossMatrix) {
  constexpr double kStep = 1e-7;
  for (int i = 0; i < 3; ++i) {
    const Vector3d axis = Vector3d::Unit(i);
    const Matrix3d numeric = (expSo3(kStep * axis) - expSo3(-kStep * axis)) / (2.0 * kStep);
    EXPECT_TRUE(numeric.isApprox(crossMatrix(axis), 1e-8));
  }
}

TEST(LogSo3Test, InvertsExpUpToHalfATurn) {
  for (const Vector3d& omega : rotationVectors()) {
    // Close to half a turn, the logarithm amplifies rounding.
    const double tolerance = omega.norm() > 3.0 ? 1e-6 : 1e-9;
    EXPECT_TRUE((logSo3(expSo3(omega)) - omega).isZero(tolerance)) << omega.transpose();
  }
}

TEST(LogSo3Test, UsesTheShorterRotation) {
  const Vector3d omega(0.0, 0.0, 1.5 * M_PI);
  EXPECT_TRUE(logSo3(expSo3(omega)).isApprox(Vector3d(0.0, 0.0, -0.5 * M_PI), 1e-12));
  EXPECT_NEAR(M_PI, logSo3(expSo3({M_PI, 0.0, 0.0})).norm(), 1e-7);
}

TEST(NormalizedTest, RestoresARotationAndKeepsTheTranslation) {
  const Pose exact = somePose(0.4);
  Pose drifted = exact;
  drifted.linear() *= 1.0 + 1e-4;
  const Pose restored = normalized(drifted);
  EXPECT_TRUE((restored.linear() * restored.linear().transpose()).isIdentity(1e-14));
  EXPECT_TRUE(restored.isApprox(exact, 1e-3));
  EXPECT_EQ(restored.translation(), drifted.translation());
}

TEST(QuaternionOfTest, HasUnitLengthAndTheSameRotation) {
  const Pose pose = somePose(1.3);
  const Eigen::Quaterniond quaternion = quaternionOf(pose);
  EXPECT_NEAR(1.0, quaternion.norm(), 1e-15);
  EXPECT_TRUE(quaternion.toRotationMatrix().isApprox(pose.linear(), 1e-14));
}

TEST(YawOfTest, IsTheAngleOfTheForwardAxis) {
  for (const double yaw : {-3.1, -1.0, 0.0, 0.5, 3.1}) {
    Pose pose = Pose::Identity();
    pose.linear() = expSo3({0.0, 0.0, yaw});
    EXPECT_NEAR(yaw, yawOf(pose), 1e-14);
    pose.linear() = pose.linear() * expSo3({0.4, 0.0, 0.0}).eval();
    EXPECT_NEAR(yaw, yawOf(pose), 1e-14) << "independent of roll";
  }
}

TEST(WrapAngleTest, StaysInTheHalfOpenInterval) {
  EXPECT_DOUBLE_EQ(M_PI, wrapAngle(M_PI));
  EXPECT_DOUBLE_EQ(M_PI, wrapAngle(-M_PI));
  EXPECT_DOUBLE_EQ(M_PI, wrapAngle(3.0 * M_PI));
  for (double angle = -20.0; angle < 20.0; angle += 0.37) {
    const double wrapped = wrapAngle(angle);
    EXPECT_GT(wrapped, -M_PI);
    EXPECT_LE(wrapped, M_PI);
    EXPECT_NEAR(std::sin(angle), std::sin(wrapped), 1e-12);
    EXPECT_NEAR(std::cos(angle), std::cos(wrapped), 1e-12);
  }
}

TEST(RobotFromOpticalTest, TurnsTheViewingDirectionForward) {
  const Pose T_robot_optical = robotFromOptical();
  EXPECT_EQ(T_robot_optical * Vector3d::UnitZ(), Vector3d::UnitX());   // view: forward
  EXPECT_EQ(T_robot_optical * Vector3d::UnitX(), -Vector3d::UnitY());  // right: minus left
  EXPECT_EQ(T_robot_optical * Vector3d::UnitY(), -Vector3d::UnitZ());  // down: minus up
}

TEST(PoseTest, RigidMotionsAreToldFromOtherMatrices) {
  const Pose pose = somePose(0.9);
  EXPECT_TRUE(isRotation(pose.linear()));
  EXPECT_FALSE(isRotation(2.0 * pose.linear()));
  EXPECT_FALSE(isRotation(-pose.linear()));  // a reflection
  EXPECT_FALSE(isRotation(Eigen::Matrix3d::Constant(std::nan(""))));
  const double farthest = pose.translation().cwiseAbs().maxCoeff();
  EXPECT_TRUE(isRigid(pose, farthest));
  EXPECT_FALSE(isRigid(pose, 0.9 * farthest));
  for (int axis = 0; axis < 3; ++axis) {
    Pose broken = pose;
    broken.translation()[axis] = std::nan("");
    EXPECT_FALSE(isRigid(broken, 1e9)) << axis;
  }
}

TEST(MrptPoseTest, RoundTripsThroughBothPoseTypes) {
  for (const double seed : {-2.0, 0.0, 0.9}) {
    const Pose pose = somePose(seed);
    EXPECT_TRUE(fromMrpt(toMrpt(pose)).isApprox(pose, 1e-12));
    EXPECT_TRUE(fromMrpt(toMrptQuat(pose)).isApprox(pose, 1e-12));
  }
}

TEST(MrptPoseTest, ComposesAndMapsPointsAsMrptDoes) {
  const Pose T_a_b = somePose(0.3);
  const Pose T_b_c = somePose(-1.1);
  EXPECT_TRUE(fromMrpt(toMrpt(T_a_b) + toMrpt(T_b_c)).isApprox(T_a_b * T_b_c, 1e-12));
  const Vector3d point(0.2, 3.0, -1.0);
  const auto mapped =
      toMrpt(T_a_b).composePoint(mrpt::math::TPoint3D(point.x(), point.y(), point.z()));
  EXPECT_TRUE(Vector3d(mapped.x, mapped.y, mapped.z).isApprox(T_a_b * point, 1e-12));
}

}  // namespace
}  // namespace headway
