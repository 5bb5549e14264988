// SPDX-License-Identifier: BSD-3-Clause
#include "pose_block.h"

#include <headway/stereo/pose_tangent.h>

namespace headway::slam {

PoseBlock blockFrom(const Pose& pose) {
  PoseBlock block;
  block << Eigen::Quaterniond(pose.linear()).coeffs(), pose.translation();
  return block;
}

Pose poseFrom(const double* block) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Map<const Eigen::Quaterniond>(block).normalized().toRotationMatrix();
  pose.translation() = Eigen::Map<const Eigen::Vector3d>(block + 4);
  return pose;
}

bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const Eigen::Map<const Eigen::Matrix<double, 6, 1>> xi(delta);
  Eigen::Map<PoseBlock> result(x_plus_delta);
  result = blockFrom(stereo::retract(poseFrom(x), xi));
  return true;
}

bool PoseManifold::PlusJacobian(const double* /*x*/, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>> matrix(jacobian);
  matrix.setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<stereo::Tangent> xi(y_minus_x);
  xi = stereo::localCoordinates(poseFrom(x), poseFrom(y), nullptr);
  return true;
}

bool PoseManifold::MinusJacobian(const double* /*x*/, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> matrix(jacobian);
  matrix.setIdentity();
  return true;
}

}  // namespace headway::slam
