// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

#include <Eigen/Core>
#include <vector>

#include "motion_prior.h"

namespace headway::objects {

/// n-point moving average of measured positions, for a moving object (Sec. III-C2).
///
/// Each position is first extrapolated to the newest one's time with the object's velocity, because
/// a plain average lags behind a moving object by half its span.
///
/// @param measurements  at least one, oldest first
/// @param points        n >= 1
/// @return              map frame [m]
[[nodiscard]] Eigen::Vector3d movingAverage(const std::vector<PlaceMeasurement>& measurements,
                                            int points, const Eigen::Vector3d& velocity);

/// The same with Gaussian weights that decrease with age.
///
/// @param sigma_s  width of the Gaussian [s]
[[nodiscard]] Eigen::Vector3d gaussianAverage(const std::vector<PlaceMeasurement>& measurements,
                                              double sigma_s, const Eigen::Vector3d& velocity);

}  // namespace headway::objects
