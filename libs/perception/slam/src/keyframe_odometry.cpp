// SPDX-License-Identifier: BSD-3-Clause
#include "keyframe_odometry.h"

#include <cmath>

namespace headway::slam {

void KeyframeOdometry::add(const MotionPrior& prior) {
  if (!link_) return;
  if (!prior.T_previous_current) {
    link_.reset();
    return;
  }
  const Pose& step = *prior.T_previous_current;
  link_ = composed(*link_, {{}, step, step.translation().norm(), logSo3(step.linear()).norm()});
}

void KeyframeOdometry::restartAt(KeyframeId keyframe) {
  link_.reset();
  if (use_) link_ = OdometryLink{keyframe, Pose::Identity(), 0.0, 0.0};
}

Eigen::Matrix<double, 6, 1> sigmaOf(const OdometryLink& link) {
  constexpr double kFloor = 0.01;      ///< backlash and time stamps [m]
  constexpr double kAlong = 0.02;      ///< scale and slip, of the path [-]
  constexpr double kSlope = 0.1;       ///< of the ground against the robot's plane [rad]
  constexpr double kYawFloor = 0.005;  ///< [rad]
  constexpr double kYawByTurn = 0.05;  ///< error of the track width [-]
  constexpr double kYawByPath = 0.01;  ///< [rad/m]
  const double plane = kFloor + kAlong * link.path_m;
  const double yaw = kYawFloor + kYawByTurn * link.turn_rad + kYawByPath * link.path_m;
  Eigen::Matrix<double, 6, 1> sigma;
  sigma << plane, plane, kFloor + kSlope * link.path_m, kSlope, kSlope, yaw;
  return sigma;
}

PoseCovariance covarianceOf(const OdometryLink& link) {
  Eigen::Matrix<double, 6, 1> sigma = sigmaOf(link);
  sigma[1] = std::hypot(sigma[1], 0.5 * link.path_m * sigma[5]);
  return sigma.cwiseAbs2().asDiagonal();
}

}  // namespace headway::slam
