// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>

namespace headway {

/// Whether a matrix can be the covariance of a place: positive semi-definite up to rounding, and
/// nowhere above 1 km^2 (finite).
[[nodiscard]] bool isCovariance(const Eigen::Matrix3d& matrix);

/// Whether no number of its boxes and no score is beyond 10^6, which no image and no sensor
/// reaches [px, m]. Numbers that are not finite are not judged.
[[nodiscard]] bool isPlausible(const Detection& detection);

}  // namespace headway
