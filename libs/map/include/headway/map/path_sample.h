#pragma once

#include <headway/core/track.h>

namespace headway::map {

/// Where a body may be at one time, if it follows one of its predicted paths.
struct PathSample {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();      ///< map frame [m]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of the centre [m^2]
};

/// A predicted path at any time: between its points in proportion, the track itself at time zero.
///
/// Beyond its last point it goes straight on, its spread growing with time as it did until there.
/// A path without points stays where the track is.
///
/// @param horizon_s  from the track's time; negative counts as zero [s]
[[nodiscard]] PathSample samplePath(const Track& track, const PredictedPath& path,
                                    double horizon_s);

}  // namespace headway::map
