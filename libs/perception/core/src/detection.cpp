// SPDX-License-Identifier: BSD-3-Clause
// Detections: boxes of objects as a detector reports them in one frame.
#include <headway/core/detection.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace headway {
namespace {

/// Greatest plausible value of a box: a coordinate of 1000 km [m], a variance of 1 km^2 [m^2].
constexpr double kMaxPlausible = 1e6;

}  // namespace

Box3d opticalBox(const Eigen::Vector3d& centre, const Eigen::Vector3d& size, double yaw,
                 const Pose& T_optical_frame) {
  const Eigen::Vector3d front(std::cos(yaw), std::sin(yaw), 0.0);
  return {T_optical_frame * centre, size.x(), size.y(), size.z(),
          opticalYaw(T_optical_frame.linear() * front)};
}

MeasuredVelocity rotated(const MeasuredVelocity& velocity, const Eigen::Matrix3d& R_new_old) {
  return {R_new_old * velocity.value, R_new_old * velocity.covariance * R_new_old.transpose(),
          velocity.age_s};
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
  return velocity.value.allFinite() && velocity.covariance.allFinite() &&
         std::isfinite(velocity.age_s);
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

bool isCovariance(const Eigen::Matrix3d& matrix) {
  constexpr double kRounding = 1e-6;      // of the largest variance
  constexpr double kMinVariance = 1e-12;  // of a place that is known exactly [m^2]
  if (!matrix.allFinite() || matrix.cwiseAbs().maxCoeff() > kMaxPlausible) return false;
  if (matrix.diagonal().minCoeff() < 0.0) return false;
  const double margin = kRounding * matrix.diagonal().maxCoeff() + kMinVariance;
  const Eigen::Matrix3d raised = matrix + margin * Eigen::Matrix3d::Identity();
  return raised.llt().info() == Eigen::Success;
}

void removeBadCovariance(Detection& detection, DropCounts& dropped) {
  if (!detection.centre_covariance || isCovariance(*detection.centre_covariance)) return;
  ++dropped["bad_covariance"];
  detection.centre_covariance.reset();
}

bool isFinite(const Detection& detection) {
  const auto& box2d = detection.box2d;
  const auto& box3d = detection.box3d;
  const auto& velocity = detection.velocity;
  return std::isfinite(detection.score) && (!box2d || isFinite(*box2d)) &&
         (!box3d || isFinite(*box3d)) && (!velocity || isFinite(*velocity));
}

bool isPlausible(const Detection& detection) {
  const auto are_near = [](std::initializer_list<double> values) {
    return std::none_of(values.begin(), values.end(), [](double value) {
      return std::isfinite(value) && std::abs(value) > kMaxPlausible;
    });
  };
  const auto& a = detection.box2d;
  const auto& b = detection.box3d;
  return are_near({detection.score}) && (!a || are_near({a->left, a->top, a->right, a->bottom})) &&
         (!b || are_near({b->centre.x(), b->centre.y(), b->centre.z(), b->length, b->width,
                          b->height, b->yaw}));
}

}  // namespace headway
