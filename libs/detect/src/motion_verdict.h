#pragma once

#include "point_follower.h"

namespace headway::detect {

/// What the sightings of a point say of it.
enum class PointVerdict {
  kUnsure,    ///< seen too few times, or between the two
  kStill,     ///< a still point explains them
  kMoving,    ///< only motion explains them
  kMismatch,  ///< nothing does: the point slid along an edge or from one thing to another
};

/// When a point counts as moving.
struct VerdictParams {
  int least_sightings = 3;
  double significance = 30.0;  ///< likelihood ratio, chi-square with 3 degrees of freedom [-]
  double least_speed = 0.6;    ///< over the ground [m/s]
  double most_speed = 60.0;    ///< [m/s]
  double speed_sigmas = 3.0;   ///< speed over its standard deviation [-]
};

/// Tests a fitted point; only its motion over the ground counts.
///
/// @param up  unit normal of the ground, in the world of the path
[[nodiscard]] PointVerdict verdictOn(const PointTrack& point, const Eigen::Vector3d& up,
                                     const VerdictParams& params);

}  // namespace headway::detect
