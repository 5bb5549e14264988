// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>
#include <headway/core/track.h>

namespace headway {

/// Whether a matrix can be the covariance of a place: positive semi-definite up to rounding, and
/// nowhere above 1 km^2 (finite).
[[nodiscard]] bool isCovariance(const Eigen::Matrix3d& matrix);

/// Removes the covariance of a box if it cannot be one, and counts it as `bad_covariance`. The box
/// then has the noise that is assumed of boxes without a covariance.
void removeBadCovariance(Detection& detection, DropCounts& dropped);

/// Whether its score and each number of its boxes and its velocity are finite.
[[nodiscard]] bool isFinite(const Detection& detection);

/// Whether no number of its boxes and no score is beyond 10^6, which no image and no sensor
/// reaches [px, m]. Numbers that are not finite are not judged.
[[nodiscard]] bool isPlausible(const Detection& detection);

}  // namespace headway
