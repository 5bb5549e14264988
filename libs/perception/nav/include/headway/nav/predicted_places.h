// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/track.h>
#include <headway/nav/time_gate.h>

#include <vector>

namespace headway::nav {

/// A predicted position of an object, with the time span for which it is valid.
struct PredictedPlace {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();      ///< map frame [m]
  double yaw = 0.0;                                      ///< direction of motion [rad]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of the centre [m^2]
  TimeSpan when;                                         ///< relative to now
};

/// Samples one predicted path from now on, the current place first, at a distance of spacing_m.
///
/// The time spans of neighbouring places overlap, so that every instant is covered. If there is
/// one place only, of a static object, its time span is unlimited.
///
/// @param age_s      age of the track: sampling starts at this horizon of the path [s]
/// @param horizon_s  sampling ends at this horizon of the path [s]
/// @param spacing_m  minimum distance of neighbouring places
/// @param out        overwritten; its memory is reused
void predictPlaces(const Track& track, const PredictedPath& path, double age_s, double horizon_s,
                   double spacing_m, std::vector<PredictedPlace>& out);

}  // namespace headway::nav
