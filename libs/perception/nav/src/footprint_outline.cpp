// SPDX-License-Identifier: BSD-3-Clause
#include <headway/nav/footprint_outline.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace headway::nav {
namespace {

using Eigen::Vector2d;

/// The farthest point of the covariance ellipse along a normal, in the map's axes.
Vector2d growth(const PlaceUncertainty& uncertainty, const Vector2d& normal) {
  const Vector2d carried = uncertainty.covariance * normal;
  const double variance = normal.dot(carried);
  if (!(variance > 0.0) || !(uncertainty.max_growth_m > 0.0)) return Vector2d::Zero();
  const Vector2d offset = uncertainty.sigmas / std::sqrt(variance) * carried;
  const double length = offset.norm();
  return length > uncertainty.max_growth_m ? Vector2d(offset * (uncertainty.max_growth_m / length))
                                           : offset;
}

/// Appends the way from one point to the next, without the first one.
void appendSegment(const Vector2d& from, const Vector2d& to, double spacing,
                   std::vector<Vector2d>& out) {
  const double length = (to - from).norm();
  const int pieces = std::max(1, static_cast<int>(std::ceil(length / spacing - 0.5)));
  for (int i = 1; i <= pieces; ++i) out.push_back(from + (to - from) * i / pieces);
}

}  // namespace

void appendOutline(const map::FootprintShape& footprint, const Vector2d& centre, double yaw,
                   const PlaceUncertainty& uncertainty, double spacing,
                   std::vector<Vector2d>& out) {
  const Eigen::Rotation2Dd turn(yaw);
  const double perimeter = 2.0 * M_PI * footprint.radius();
  const int normals = std::clamp(static_cast<int>(std::ceil(perimeter / spacing)), 8, 24);
  Vector2d previous = Vector2d::Zero();
  for (int i = 0; i <= normals; ++i) {
    // Half a step off the axes, where a box's support point is not unique.
    const double angle = 2.0 * M_PI * (i + 0.5) / normals;
    const Vector2d normal(std::cos(angle), std::sin(angle));
    const Vector2d point =
        centre + turn * footprint.supportPoint(normal) + growth(uncertainty, turn * normal);
    if (i > 0) appendSegment(previous, point, spacing, out);
    previous = point;
  }
}

bool covers(const map::FootprintShape& footprint, const Vector2d& centre, double yaw, double margin,
            const Vector2d& point) {
  const Vector2d local = Eigen::Rotation2Dd(-yaw) * (point - centre);
  return std::abs(local.x()) <= 0.5 * footprint.length_m + margin &&
         std::abs(local.y()) <= 0.5 * footprint.width_m + margin;
}

}  // namespace headway::nav
