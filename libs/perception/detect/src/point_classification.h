// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "point_follower.h"

namespace headway::detect {

/// Motion of a followed point.
enum class PointClass {
  kUnknown,   ///< observed too few times, or not significant
  kStatic,    ///< a static point explains its observations
  kMoving,    ///< only motion explains its observations
  kMismatch,  ///< neither does: it slid along an edge or to another object
};

/// Parameters of classifyPoint().
struct PointClassParams {
  int min_observations = 3;
  double significance = 30.0;  ///< likelihood ratio, chi-square with 3 degrees of freedom [-]
  double min_speed = 0.6;      ///< over the ground [m/s]
  double max_speed = 60.0;     ///< [m/s]
  double speed_sigmas = 3.0;   ///< speed over its standard deviation [-]
};

/// Classifies a fitted point by its motion over the ground.
///
/// @param up  unit normal of the ground, in the world of the path
[[nodiscard]] PointClass classifyPoint(const PointTrack& point, const Eigen::Vector3d& up,
                                       const PointClassParams& params);

}  // namespace headway::detect
