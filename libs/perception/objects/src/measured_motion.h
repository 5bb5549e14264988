// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "motion_prior.h"

namespace headway::objects {

/// Velocity on the ground plane from the measured positions of an object.
struct MeasuredMotion {
  Eigen::Vector2d velocity;    ///< [m/s]
  Eigen::Matrix2d covariance;  ///< [m^2/s^2]
};

/// Weighted least-squares line through the positions of the last `window_s`, without the one of the
/// largest residual, so that a single outlier does not appear as motion.
///
/// @return nullopt for fewer than three places
[[nodiscard]] std::optional<MeasuredMotion> measuredMotion(
    const std::vector<PlaceMeasurement>& places, double window_s);

}  // namespace headway::objects
