// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/track.h>

#include <Eigen/Core>
#include <vector>

namespace headway::objects {

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

}  // namespace headway::objects
