// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/eval/moving_object_error.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace headway::eval {

/// nullopt of an empty whole.
inline std::optional<double> ratioOf(std::size_t part, std::size_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

/// Length over the ground of a vector in the camera's frame [m].
inline double groundRange(const Eigen::Vector3d& vector) {
  return std::hypot(vector.x(), vector.z());
}

/// Largest distance between a row and the label at this range that it is matched to [m].
inline double matchingDistance(const MovingObjectParams& params, double range_m) {
  return std::max(params.max_distance_m, params.max_distance_ratio * range_m);
}

}  // namespace headway::eval
