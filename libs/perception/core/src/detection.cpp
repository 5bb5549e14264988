// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/detection.h>

#include <cmath>

namespace headway {

Box3d opticalBox(const Eigen::Vector3d& centre, const Eigen::Vector3d& size, double yaw,
                 const Pose& T_optical_frame) {
  const Eigen::Vector3d front(std::cos(yaw), std::sin(yaw), 0.0);
  return {T_optical_frame * centre, size.x(), size.y(), size.z(),
          opticalYaw(T_optical_frame.linear() * front)};
}

MeasuredVelocity rotated(const MeasuredVelocity& velocity, const Eigen::Matrix3d& R_new_old) {
  return {R_new_old * velocity.value, R_new_old * velocity.covariance * R_new_old.transpose()};
}

bool isFinite(const Box2d& box) {
  return std::isfinite(box.left) && std::isfinite(box.top) && std::isfinite(box.right) &&
         std::isfinite(box.bottom);
}

bool isFinite(const Box3d& box) {
  return box.centre.allFinite() && std::isfinite(box.length) && std::isfinite(box.width) &&
         std::isfinite(box.height) && std::isfinite(box.yaw);
}

bool isFinite(const MeasuredVelocity& velocity) {
  return velocity.value.allFinite() && velocity.covariance.allFinite();
}

Detections inSensorFrame(const Detections& detections, const Pose& T_robot_sensor) {
  Detections result = detections;
  const Pose T_new_old = T_robot_sensor.inverse() * detections.T_robot_sensor;
  if (T_new_old.isApprox(Pose::Identity(), 1e-9)) return result;
  result.T_robot_sensor = T_robot_sensor;
  for (auto& detection : result.items) {
    if (auto& box = detection.box3d) {
      box->yaw = opticalYaw(T_new_old.linear() * frontOf(*box));
      box->centre = T_new_old * box->centre;
    }
    if (auto& covariance = detection.centre_covariance) {
      covariance = T_new_old.linear() * *covariance * T_new_old.linear().transpose();
    }
    if (detection.velocity) detection.velocity = rotated(*detection.velocity, T_new_old.linear());
  }
  return result;
}

Eigen::Vector3d frontOf(const Box3d& box) { return {std::cos(box.yaw), 0.0, -std::sin(box.yaw)}; }

double opticalYaw(const Eigen::Vector3d& direction) {
  return wrapAngle(std::atan2(-direction.z(), direction.x()));
}

}  // namespace headway
