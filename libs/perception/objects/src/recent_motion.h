// SPDX-License-Identifier: BSD-3-Clause
// Motion over the ground from an object's past positions.
#pragma once

#include <headway/core/pose.h>
#include <headway/core/track.h>

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <vector>

#include "motion_prior.h"

namespace headway::objects {

/// Standard deviation, mean over the directions on the ground.
[[nodiscard]] inline double meanSigma(const Eigen::Matrix2d& covariance) {
  return std::sqrt(0.5 * covariance.trace());
}

inline constexpr double kMinTurningSpeed_mps = 0.3;  ///< below, changes of direction are noise

/// Displacements shorter than this have no direction [m].
inline constexpr double kNoDirection_m = 1e-6;

/// Position on the ground plane at a past time, as positionAt().
[[nodiscard]] Eigen::Vector2d placeAt(const std::vector<TrajectoryPoint>& path, Time time);

/// Time from the first sample to the last [s]; 0 for fewer than two.
[[nodiscard]] double spanOf(const std::vector<TrajectoryPoint>& path);

/// Mean velocity over the last `window_s`, or over the whole path if it is shorter.
///
/// @return velocity on the ground plane [m/s]; zero for fewer than two samples
[[nodiscard]] Eigen::Vector2d recentVelocity(const std::vector<TrajectoryPoint>& path,
                                             double window_s);

/// `direction` with length 1; `fallback` if it has none.
[[nodiscard]] Eigen::Vector2d unitOr(const Eigen::Vector2d& direction,
                                     const Eigen::Vector2d& fallback);

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
