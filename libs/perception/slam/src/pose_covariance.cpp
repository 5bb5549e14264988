// SPDX-License-Identifier: BSD-3-Clause
#include "pose_covariance.h"

#include <cmath>

namespace headway::slam {

PoseCovariance composedCovariance(const PoseCovariance& of_ab, const Pose& T_b_c,
                                  const PoseCovariance& of_bc) {
  const Eigen::Matrix3d R = T_b_c.linear().transpose();
  const Eigen::Vector3d& t = T_b_c.translation();
  PoseCovariance adjoint = PoseCovariance::Zero();
  adjoint.topLeftCorner<3, 3>() = R;
  adjoint.topRightCorner<3, 3>() = -R * crossMatrix(t);
  adjoint.bottomRightCorner<3, 3>() = R;
  return adjoint * of_ab * adjoint.transpose() + of_bc;
}

double positionSigma(const PoseCovariance& covariance) {
  return std::sqrt(covariance.topLeftCorner<3, 3>().trace() / 3.0);
}

double rotationSigma(const PoseCovariance& covariance) {
  return std::sqrt(covariance.bottomRightCorner<3, 3>().trace() / 3.0);
}

}  // namespace headway::slam
