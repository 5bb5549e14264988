// SPDX-License-Identifier: BSD-3-Clause
#include <headway/stereo/pose_tangent.h>

#include <cmath>

namespace headway::stereo {

Pose retract(const Pose& pose, const Tangent& xi) {
  Pose moved = pose;
  moved.translation() += pose.linear() * xi.head<3>();
  moved.linear() = pose.linear() * expSo3(xi.tail<3>());
  return normalized(moved);
}

Tangent localCoordinates(const Pose& from, const Pose& to, Eigen::Matrix<double, 6, 6>* jacobian) {
  const Pose difference = from.inverse(Eigen::Isometry) * to;
  const Eigen::Vector3d phi = logSo3(difference.linear());
  if (jacobian != nullptr) {
    jacobian->setZero();
    jacobian->topLeftCorner<3, 3>() = difference.linear();
    jacobian->bottomRightCorner<3, 3>() = inverseRightJacobian(phi);
  }
  Tangent xi;
  xi << difference.translation(), phi;
  return xi;
}

Eigen::Matrix3d inverseRightJacobian(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const Eigen::Matrix3d skew = crossMatrix(phi);
  const double factor = angle < 1e-4 ? 1.0 / 12.0
                                     : 1.0 / (angle * angle) - (1.0 + std::cos(angle)) /
                                                                   (2.0 * angle * std::sin(angle));
  return Eigen::Matrix3d::Identity() + 0.5 * skew + factor * skew * skew;
}

}  // namespace headway::stereo
