// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/track.h>

namespace headway::map {

/// Position of an object at one time along one of its predicted paths.
struct PathSample {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();      ///< map frame [m]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of the centre [m^2]
};

/// Interpolates a predicted path linearly between its points, and the track itself at time zero.
///
/// Beyond its last point the path is extrapolated straight, with a covariance that grows at the
/// same rate. A path without points remains at the track's position.
///
/// @param horizon_s  from the track's time; negative counts as zero [s]
[[nodiscard]] PathSample samplePath(const Track& track, const PredictedPath& path,
                                    double horizon_s);

}  // namespace headway::map
