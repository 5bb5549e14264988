// SPDX-License-Identifier: BSD-3-Clause
#include "noise_scale.h"

#include <Eigen/LU>
#include <algorithm>

namespace headway::objects {

void NoiseScale::learn(const ExpectedPlace& expected, const MeasuredBox& detection) {
  constexpr double kExpected = 2.0;  // mean of chi-squared with two degrees of freedom
  constexpr double kOutlier = 6.0;   // larger distances are clamped
  constexpr double kMinScale = 0.05;
  constexpr double kMaxScale = 4.0;
  const Eigen::Vector2d offset = (detection.position - expected.position).head<2>();
  const Eigen::Matrix2d S = expected.covariance + detection.covariance;
  const double squared = std::min(kOutlier, offset.dot(S.inverse() * offset));
  scale_ *= 1.0 + adaptation_ * (squared / kExpected - 1.0);
  scale_ = std::clamp(scale_, kMinScale, kMaxScale);
}

MeasuredBox NoiseScale::scaled(MeasuredBox box) const {
  box.covariance *= scale_ * scale_;
  box.vertical_variance *= scale_ * scale_;
  return box;
}

}  // namespace headway::objects
