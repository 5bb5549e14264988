#pragma once

#include <headway/core/pose.h>

#include <Eigen/Core>
#include <vector>

#include "motion_prior.h"

namespace headway::objects {

/// n-point moving average of measured places, for an object that moves (Sec. III-C2).
///
/// Each place is first carried on to the newest one's time with the object's velocity: a plain
/// average of a moving object's places lies behind it by half the span it covers.
///
/// @param measurements  one at least, oldest first
/// @param points        n >= 1
/// @return              map frame [m]
[[nodiscard]] Eigen::Vector3d movingAverage(const std::vector<PlaceMeasurement>& measurements,
                                            int points, const Eigen::Vector3d& velocity);

/// The same with Gaussian weights that fall off with age.
///
/// @param sigma_s  width of the Gaussian [s]
[[nodiscard]] Eigen::Vector3d gaussianAverage(const std::vector<PlaceMeasurement>& measurements,
                                              double sigma_s, const Eigen::Vector3d& velocity);

}  // namespace headway::objects
