#pragma once

#include <headway/core/track.h>
#include <headway/nav/time_gate.h>

#include <vector>

namespace headway::nav {

/// Where a body may be, and when.
struct PredictedPlace {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();      ///< map frame [m]
  double yaw = 0.0;                                      ///< along its way [rad]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of the centre [m^2]
  TimeSpan when;                                         ///< from now on
};

/// Places of one predicted path from now on, the present one first, `spacing` apart.
///
/// Neighbouring places share time, so that no instant falls between them. Only one place, of a
/// body that stays, is open-ended: it is occupied for ever.
///
/// @param age_s      how long ago the track was like this: the path is entered so far in [s]
/// @param horizon_s  the path is left here, counted from the track's time [s]
/// @param out        overwritten; its memory is used again
void predictPlaces(const Track& track, const PredictedPath& path, double age_s, double horizon_s,
                   double spacing_m, std::vector<PredictedPlace>& out);

}  // namespace headway::nav
