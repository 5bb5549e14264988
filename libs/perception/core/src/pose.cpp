// SPDX-License-Identifier: BSD-3-Clause
// Poses, rotations and the frames of robot and camera.
#include <headway/core/pose.h>

#include <cmath>

namespace headway {

Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

Eigen::Matrix3d expSo3(const Eigen::Vector3d& omega) {
  const double angle = omega.norm();
  if (angle < 1e-12) {
    return Eigen::Quaterniond(1.0, 0.5 * omega.x(), 0.5 * omega.y(), 0.5 * omega.z())
        .normalized()
        .toRotationMatrix();
  }
  return Eigen::AngleAxisd(angle, omega / angle).toRotationMatrix();
}

Eigen::Vector3d logSo3(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

Eigen::Quaterniond quaternionOf(const Pose& pose) {
  return Eigen::Quaterniond(pose.linear()).normalized();
}

Pose normalized(const Pose& pose) {
  Pose result = pose;
  result.linear() = quaternionOf(pose).toRotationMatrix();
  return result;
}

bool isRotation(const Eigen::Matrix3d& matrix, double tolerance) {
  return matrix.allFinite() && (matrix * matrix.transpose()).isIdentity(tolerance) &&
         matrix.determinant() > 0.0;
}

bool isRigid(const Pose& pose, double max_distance_m) {
  return pose.translation().allFinite() &&
         pose.translation().cwiseAbs().maxCoeff() <= max_distance_m && isRotation(pose.linear());
}

double yawOf(const Pose& pose) { return std::atan2(pose.linear()(1, 0), pose.linear()(0, 0)); }

double wrapAngle(double angle) {
  const double wrapped = std::remainder(angle, 2.0 * M_PI);
  return wrapped <= -M_PI ? wrapped + 2.0 * M_PI : wrapped;
}

Pose robotFromOptical() {
  Pose turn = Pose::Identity();
  turn.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return turn;
}

}  // namespace headway
