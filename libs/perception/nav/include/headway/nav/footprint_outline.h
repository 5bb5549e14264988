// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/map/contact_probability.h>

#include <vector>

namespace headway::nav {

/// Uncertainty of a position, by which a footprint is enlarged.
struct PlaceUncertainty {
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of the centre [m^2]
  double sigmas = 1.0;                                   ///< standard deviations of the growth [-]
  double max_growth_m = 0.4;                             ///< limit of the growth [m]
};

/// Points along the edge of a footprint, enlarged by the uncertainty of its position.
///
/// The Minkowski sum of the footprint and the covariance ellipse: the point with outward normal n
/// is the footprint's support point plus sigmas * C n / sqrt(n' C n), of at most max_growth_m.
/// Laws: the outline encloses the footprint; the outline of a larger covariance encloses that of a
/// smaller one; rotating footprint and covariance rotates the outline.
///
/// @param centre   map frame [m]
/// @param yaw      of the footprint's front [rad]
/// @param spacing  approximate maximum distance of neighbouring points [m]
/// @param out      points are appended to it, map frame [m]
void appendOutline(const map::FootprintShape& footprint, const Eigen::Vector2d& centre, double yaw,
                   const PlaceUncertainty& uncertainty, double spacing,
                   std::vector<Eigen::Vector2d>& out);

/// Whether a point lies in the footprint, as a rectangle and enlarged by a margin on all sides.
///
/// @param centre, point  map frame [m]
/// @param yaw            of the footprint's front [rad]
/// @param margin         [m]
[[nodiscard]] bool covers(const map::FootprintShape& footprint, const Eigen::Vector2d& centre,
                          double yaw, double margin, const Eigen::Vector2d& point);

}  // namespace headway::nav
