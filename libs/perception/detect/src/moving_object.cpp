// SPDX-License-Identifier: BSD-3-Clause
#include "moving_object.h"

#include <headway/core/box_overlap.h>

#include <algorithm>
#include <cmath>

namespace headway::detect {
namespace {

constexpr double kMargin = 0.1;     // around the footprint [m]
constexpr double kLookAhead = 0.1;  // of motion by which the footprint is extended [s]
constexpr double kBehind = 1.0;     // depth beyond which an overlap in the image is background [m]
constexpr double kBehindPerMetre = 0.02;   // growth with depth [m/m]
constexpr double kSameVelocity = 0.3;      // ratio of the difference between parts of one object
constexpr double kMinDirectedSpeed = 0.5;  // from which the direction is known [m/s]

}  // namespace

bool isPartOf(const ObjectExtent& part, const MovingObject& object) {
  const ObjectExtent& whole = object.extent;
  const Eigen::Vector3d off = part.box.centre - whole.box.centre;
  const double behind = 0.5 * whole.box.length + kBehind + kBehindPerMetre * whole.box.centre.z();
  const bool seen_there =
      ratioInside(part.box2d, whole.box2d) > 0.5 || overlap2d(part.box2d, whole.box2d) > 0.3;
  if (seen_there && off.norm() < behind) return true;
  const double margin = kMargin + kLookAhead * object.velocity.value.norm();
  const Eigen::Vector3d front = frontOf(whole.box);
  const auto covers = [&](const Eigen::Vector3d& place) {
    const Eigen::Vector3d to = place - whole.box.centre;
    return std::abs(front.dot(to)) < 0.5 * whole.box.length + margin &&
           std::abs(front.cross(to).y()) < 0.5 * whole.box.width + margin;
  };
  // The box of a part is completed to a usual size behind what is visible, so both are tried.
  return covers(part.box.centre) || covers(part.surface);
}

bool isPartOfAny(const ObjectExtent& part, const std::vector<MovingObject>& objects) {
  return std::any_of(objects.begin(), objects.end(),
                     [&](const MovingObject& object) { return isPartOf(part, object); });
}

bool isAsFast(const Eigen::Vector3d& velocity, const Eigen::Vector3d& other) {
  return (velocity - other).norm() < kSameVelocity * std::max(velocity.norm(), other.norm());
}

bool isOpposite(const Eigen::Vector3d& velocity, const Eigen::Vector3d& other) {
  return velocity.dot(other) < 0.0 && velocity.norm() > kMinDirectedSpeed &&
         other.norm() > kMinDirectedSpeed;
}

}  // namespace headway::detect
