// SPDX-License-Identifier: BSD-3-Clause
// Overlap of boxes in images and over the ground.
#pragma once

#include <headway/core/detection.h>

#include <Eigen/Core>

namespace headway {

/// Footprint of a box: a rectangle in a plane.
struct Footprint {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< [m]
  double length = 0.0;                               ///< along the front's direction [m]
  double width = 0.0;                                ///< across it [m]
  double yaw = 0.0;  ///< of the front, from the plane's first axis to its second [rad]
};

/// Area of the intersection [m^2].
///
/// @see  Sutherland & Hodgman 1974, "Reentrant polygon clipping"
[[nodiscard]] double intersectionArea(const Footprint& a, const Footprint& b);

/// Area of intersection over area of union of two image boxes; 0 if they are disjoint.
[[nodiscard]] double overlap2d(const Box2d& a, const Box2d& b);

/// Ratio of a box's area inside a region; 0 if the box has no area.
[[nodiscard]] double ratioInside(const Box2d& box, const Box2d& region);

/// Volume of intersection over volume of union of two upright boxes; 0 if they are disjoint.
[[nodiscard]] double overlap3d(const Box3d& a, const Box3d& b);

}  // namespace headway
