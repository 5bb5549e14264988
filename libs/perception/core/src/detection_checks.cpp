// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/detection_checks.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace headway {

bool isCovariance(const Eigen::Matrix3d& matrix) {
  constexpr double kMaxVariance = 1e6;    // [m^2]
  constexpr double kRounding = 1e-6;      // of the largest variance
  constexpr double kMinVariance = 1e-12;  // of a place that is known exactly [m^2]
  if (!matrix.allFinite() || matrix.cwiseAbs().maxCoeff() > kMaxVariance) return false;
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
  constexpr double kMax = 1e6;
  const auto are_near = [](std::initializer_list<double> values) {
    return std::none_of(values.begin(), values.end(), [](double value) {
      return std::isfinite(value) && std::abs(value) > kMax;
    });
  };
  const auto& a = detection.box2d;
  const auto& b = detection.box3d;
  return are_near({detection.score}) && (!a || are_near({a->left, a->top, a->right, a->bottom})) &&
         (!b || are_near({b->centre.x(), b->centre.y(), b->centre.z(), b->length, b->width,
                          b->height, b->yaw}));
}

}  // namespace headway
