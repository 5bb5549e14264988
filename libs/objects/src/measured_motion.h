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

/// Straight line through the places of the last `window_s` by weighted least squares, without the
/// place that fits worst: one box that is off by more than it says makes no motion.
///
/// @return nullopt for fewer than three places
[[nodiscard]] std::optional<MeasuredMotion> measuredMotion(
    const std::vector<PlaceMeasurement>& places, double window_s);

}  // namespace headway::objects
