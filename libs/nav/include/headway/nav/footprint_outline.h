#pragma once

#include <headway/map/footprint_shape.h>

#include <vector>

namespace headway::nav {

/// How far a body must grow along each of its directions for the uncertainty about its place.
struct PlaceUncertainty {
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of the centre [m^2]
  double sigmas = 1.0;
  double max_growth_m = 0.4;
};

/// Points along the edge of the body, grown by the uncertainty about its place.
///
/// The Minkowski sum of the body and the covariance ellipse: the point whose outward normal is n
/// lies at the body's support point plus sigmas * C n / sqrt(n' C n), no farther than max_growth.
/// Laws: the outline holds the body; a greater covariance gives an outline that holds the smaller
/// one's; turning body and covariance turns the outline.
///
/// @param centre   map frame [m]
/// @param yaw      of the body's front [rad]
/// @param spacing  largest distance between neighbours, roughly [m]
/// @param out      points are appended to it, map frame
void appendOutline(const map::FootprintShape& body, const Eigen::Vector2d& centre, double yaw,
                   const PlaceUncertainty& uncertainty, double spacing,
                   std::vector<Eigen::Vector2d>& out);

/// Whether a point lies in the body grown by a margin on all sides; as box, also for people.
[[nodiscard]] bool covers(const map::FootprintShape& body, const Eigen::Vector2d& centre,
                          double yaw, double margin, const Eigen::Vector2d& point);

}  // namespace headway::nav
