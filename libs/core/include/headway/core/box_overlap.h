#pragma once

#include <headway/core/detection.h>

#include <Eigen/Core>

namespace headway {

/// What a box covers of the ground: a rectangle anywhere in a plane.
struct Footprint {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< [m]
  double length = 0.0;                               ///< along the front's direction [m]
  double width = 0.0;                                ///< across it [m]
  double yaw = 0.0;  ///< of the front, from the plane's first axis to its second [rad]
};

/// Area that both cover [m^2].
///
/// @see  Sutherland & Hodgman 1974, "Reentrant polygon clipping"
[[nodiscard]] double intersectionArea(const Footprint& a, const Footprint& b);

/// Area of intersection over area of union of two image boxes; 0 if they do not meet.
[[nodiscard]] double overlap2d(const Box2d& a, const Box2d& b);

/// Share of a box's area that lies inside a region; 0 if the box has no area.
[[nodiscard]] double shareInside(const Box2d& box, const Box2d& region);

/// Volume of intersection over volume of union of two upright boxes; 0 if they do not meet.
[[nodiscard]] double overlap3d(const Box3d& a, const Box3d& b);

}  // namespace headway
