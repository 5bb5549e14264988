// SPDX-License-Identifier: BSD-3-Clause
// Reprojection errors of stereo measurements and their derivatives by point and pose.
#include <headway/stereo/stereo_residual.h>

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

Eigen::Matrix3d projectionJacobian(const Eigen::Vector3d& point_cam, const StereoCamera& camera) {
  const double inverse_depth = 1.0 / point_cam.z();
  const double fx = camera.fx * inverse_depth;
  const double fy = camera.fy * inverse_depth;
  Eigen::Matrix3d jacobian;
  jacobian << fx, 0.0, -fx * (point_cam.x() * inverse_depth),  //
      0.0, fy, -fy * (point_cam.y() * inverse_depth),          //
      0.0, 0.0, -fx * camera.baseline_m * inverse_depth;
  return jacobian;
}

Eigen::Vector3d stereoResidual(const Eigen::Vector3d& point_cam, const Eigen::Vector3d& uvd,
                               const Eigen::Vector3d& weights, const StereoCamera& camera,
                               Eigen::Matrix3d* jacobian) {
  const double inverse_depth = 1.0 / point_cam.z();
  const Eigen::Vector3d projected(camera.fx * (point_cam.x() * inverse_depth) + camera.cx,
                                  camera.fy * (point_cam.y() * inverse_depth) + camera.cy,
                                  camera.fx * camera.baseline_m * inverse_depth);
  if (jacobian != nullptr) {
    *jacobian = weights.asDiagonal() * projectionJacobian(point_cam, camera);
  }
  return weights.cwiseProduct(projected - uvd);
}

Eigen::Vector3d stereoResidual(const Eigen::Vector3d& point_cam,
                               const StereoMeasurement& measurement, const StereoCamera& camera,
                               Eigen::Matrix3d* jacobian) {
  const double weight = 1.0 / measurement.sigma_px;
  const double weight_disparity = measurement.stereo ? 1.0 / measurement.sigma_disparity_px : 0.0;
  return stereoResidual(point_cam, {measurement.uv.x(), measurement.uv.y(), measurement.disparity},
                        {weight, weight, weight_disparity}, camera, jacobian);
}

Eigen::Matrix<double, 3, 6> pointByPose(const Eigen::Vector3d& point_cam) {
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian << -Eigen::Matrix3d::Identity(), crossMatrix(point_cam);
  return jacobian;
}

}  // namespace headway::stereo
