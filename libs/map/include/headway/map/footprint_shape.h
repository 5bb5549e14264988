#pragma once

#include <headway/core/track.h>

#include <vector>

namespace headway::map {

/// The ground a body covers: a box or, for people, the ellipse inside it. All zero: a point.
struct FootprintShape {
  double length_m = 0.0;
  double width_m = 0.0;
  bool round = false;

  /// Of a circle about the centre that holds it [m].
  [[nodiscard]] double radius() const;

  /// Its farthest point along a direction, both in its own axes [m].
  [[nodiscard]] Eigen::Vector2d supportPoint(const Eigen::Vector2d& normal) const;
};

/// People are round, everything else is a box.
[[nodiscard]] FootprintShape footprintOf(const Track& track);

/// The places of b's centre, relative to a's, at which the two bodies overlap.
///
/// Their Minkowski sum, as a convex polygon, counter-clockwise. Round parts are inscribed: at most
/// 0.5 % too small.
///
/// @param yaw_a, yaw_b  of the bodies' fronts, and of the result: map axes [rad]
[[nodiscard]] std::vector<Eigen::Vector2d> contactRegion(const FootprintShape& a, double yaw_a,
                                                         const FootprintShape& b, double yaw_b);

/// The probability that a normally distributed point lies in a convex polygon, to about 1 %.
///
/// @param polygon     three corners or more, in order; fewer: 0
/// @param covariance  of the point [m^2]; what is less than (1 cm)^2 is taken for that
[[nodiscard]] double probabilityInside(const std::vector<Eigen::Vector2d>& polygon,
                                       const Eigen::Vector2d& mean,
                                       const Eigen::Matrix2d& covariance);

}  // namespace headway::map
