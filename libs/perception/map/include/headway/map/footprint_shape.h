// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/track.h>

#include <vector>

namespace headway::map {

/// Footprint of an object or robot: a rectangle or its inscribed ellipse. All zero: a point.
struct FootprintShape {
  double length_m = 0.0;
  double width_m = 0.0;
  bool round = false;

  /// Of the smallest circle about the centre that encloses it [m].
  [[nodiscard]] double radius() const;

  /// Its farthest point along a direction, both in its own axes, x along length_m [m].
  [[nodiscard]] Eigen::Vector2d supportPoint(const Eigen::Vector2d& normal) const;
};

/// The footprint of a track: elliptic for people, else a rectangle.
[[nodiscard]] FootprintShape footprintOf(const Track& track);

/// The positions of b's centre relative to a's at which the footprints overlap.
///
/// Their Minkowski sum, as a convex polygon in counter-clockwise order. Ellipses are replaced by
/// inscribed polygons, at most 0.5 % too small.
///
/// @param yaw_a, yaw_b  of the footprints' fronts [rad]
/// @return              corners, map axes [m]
[[nodiscard]] std::vector<Eigen::Vector2d> contactRegion(const FootprintShape& a, double yaw_a,
                                                         const FootprintShape& b, double yaw_b);

/// The probability that a normally distributed point lies in a convex polygon, to about 1 %.
///
/// @param polygon     corners in order; fewer than three: the result is 0
/// @param covariance  of the point [m^2]; variances are at least (1 cm)^2
[[nodiscard]] double probabilityInside(const std::vector<Eigen::Vector2d>& polygon,
                                       const Eigen::Vector2d& mean,
                                       const Eigen::Matrix2d& covariance);

}  // namespace headway::map
