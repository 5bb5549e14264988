// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace headway::objects {

/// Standard deviation, mean over the directions on the ground.
[[nodiscard]] inline double meanSigma(const Eigen::Matrix2d& covariance) {
  return std::sqrt(0.5 * covariance.trace());
}

}  // namespace headway::objects
