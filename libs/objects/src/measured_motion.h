#pragma once

#include <headway/core/pose.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "motion_prior.h"

namespace headway::objects {

/// Velocity on the ground plane that the measured places of an object show.
struct MeasuredMotion {
  Eigen::Vector2d velocity;    ///< [m/s]
  Eigen::Matrix2d covariance;  ///< [m^2/s^2]
};

/// Weighted least-squares line through the places of the last `window_s`, without the one with the
/// greatest residual: a single outlier among the boxes must not look like motion.
///
/// @return nullopt for fewer than three places
[[nodiscard]] std::optional<MeasuredMotion> measuredMotion(
    const std::vector<PlaceMeasurement>& places, double window_s);

}  // namespace headway::objects
