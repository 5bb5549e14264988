#include "mover.h"

#include <headway/core/box_overlap.h>

#include <algorithm>
#include <cmath>

namespace headway::detect {
namespace {

constexpr double kMargin = 0.1;           // around the ground that a mover covers [m]
constexpr double kAtOnce = 0.1;           // in which nobody gets out of its way [s]
constexpr double kBehind = 1.0;           // what is seen there and farther off is behind it [m]
constexpr double kBehindPerMetre = 0.02;  // growth with depth [m/m]
constexpr double kSameVelocity = 0.3;     // difference between parts of one thing, share
constexpr double kSurelyMoves = 0.5;      // speed whose direction is known [m/s]

}  // namespace

bool isPartOf(const ObjectExtent& piece, const Mover& mover) {
  const ObjectExtent& whole = mover.extent;
  const Eigen::Vector3d off = piece.box.centre - whole.box.centre;
  const double behind = 0.5 * whole.box.length + kBehind + kBehindPerMetre * whole.box.centre.z();
  const bool seen_there =
      ratioInside(piece.box2d, whole.box2d) > 0.5 || overlap2d(piece.box2d, whole.box2d) > 0.3;
  if (seen_there && off.norm() < behind) return true;
  const double margin = kMargin + kAtOnce * mover.velocity.value.norm();
  const Eigen::Vector3d front = frontOf(whole.box);
  const auto covers = [&](const Eigen::Vector3d& place) {
    const Eigen::Vector3d to = place - whole.box.centre;
    return std::abs(front.dot(to)) < 0.5 * whole.box.length + margin &&
           std::abs(front.cross(to).y()) < 0.5 * whole.box.width + margin;
  };
  // The box of a piece reaches as far behind what is seen of it as the whole thing does.
  return covers(piece.box.centre) || covers(piece.surface);
}

bool isPartOfAny(const ObjectExtent& piece, const std::vector<Mover>& movers) {
  return std::any_of(movers.begin(), movers.end(),
                     [&](const Mover& mover) { return isPartOf(piece, mover); });
}

bool isAsFast(const Eigen::Vector3d& velocity, const Eigen::Vector3d& other) {
  return (velocity - other).norm() < kSameVelocity * std::max(velocity.norm(), other.norm());
}

bool isOpposite(const Eigen::Vector3d& velocity, const Eigen::Vector3d& other) {
  return velocity.dot(other) < 0.0 && velocity.norm() > kSurelyMoves && other.norm() > kSurelyMoves;
}

}  // namespace headway::detect
