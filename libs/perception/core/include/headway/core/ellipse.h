// SPDX-License-Identifier: BSD-3-Clause
// Ellipses of equal probability of a plane covariance.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace headway {

/// Half axes of the ellipse of one standard deviation of a place on the ground.
struct Ellipse {
  double major = 0.0;  ///< [m]
  double minor = 0.0;  ///< [m]
  double angle = 0.0;  ///< of the major axis about z, from x [rad]
};

/// @param covariance  of (x, y), positive semi-definite [m^2]
[[nodiscard]] inline Ellipse sigmaEllipse(const Eigen::Matrix2d& covariance) {
  const double mean = 0.5 * covariance.trace();
  const double half_difference = 0.5 * (covariance(0, 0) - covariance(1, 1));
  const double radius = std::hypot(half_difference, covariance(0, 1));
  return {std::sqrt(std::max(0.0, mean + radius)), std::sqrt(std::max(0.0, mean - radius)),
          0.5 * std::atan2(covariance(0, 1), half_difference)};
}

}  // namespace headway
