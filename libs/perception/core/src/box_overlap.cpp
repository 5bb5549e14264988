// SPDX-License-Identifier: BSD-3-Clause
// Overlap of boxes in images and over the ground.
#include <headway/core/box_overlap.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace headway {
namespace {

/// A convex polygon: a rectangle cut by at most four lines has at most eight corners.
struct Polygon {
  std::array<Eigen::Vector2d, 8> corners;
  std::size_t size = 0;

  void add(const Eigen::Vector2d& corner) {
    if (size < corners.size()) corners[size++] = corner;
  }
};

/// The part of the polygon where normal . x <= limit.
Polygon cut(const Polygon& polygon, const Eigen::Vector2d& normal, double limit) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const auto& from = polygon.corners[i];
    const auto& to = polygon.corners[(i + 1) % polygon.size];
    const double outside_from = normal.dot(from) - limit;
    const double outside_to = normal.dot(to) - limit;
    if (outside_from <= 0.0) kept.add(from);
    if (outside_from * outside_to < 0.0) {
      kept.add(from + outside_from / (outside_from - outside_to) * (to - from));
    }
  }
  return kept;
}

double areaOf(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const auto& a = polygon.corners[i];
    const auto& b = polygon.corners[(i + 1) % polygon.size];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * std::abs(twice);
}

/// Seen from above in the optical frame: first axis x, second axis -z, so yaw keeps its sense.
Footprint footprintOf(const Box3d& box) {
  return {{box.centre.x(), -box.centre.z()}, box.length, box.width, box.yaw};
}

double intersection2d(const Box2d& a, const Box2d& b) {
  const double width = std::min(a.right, b.right) - std::max(a.left, b.left);
  const double height = std::min(a.bottom, b.bottom) - std::max(a.top, b.top);
  return width > 0.0 && height > 0.0 ? width * height : 0.0;
}

}  // namespace

/// In double precision and without allocating; OpenCV's intersectConvexConvex computes in floats.
double intersectionArea(const Footprint& a, const Footprint& b) {
  const double reach = std::hypot(a.length, a.width) + std::hypot(b.length, b.width);
  const Eigen::Vector2d offset = b.centre - a.centre;
  if (!(offset.squaredNorm() <= 0.25 * reach * reach)) return 0.0;
  const Eigen::Vector2d along(std::cos(a.yaw), std::sin(a.yaw));
  const Eigen::Vector2d across(-along.y(), along.x());
  const Eigen::Vector2d half_length =
      0.5 * b.length * Eigen::Vector2d(std::cos(b.yaw), std::sin(b.yaw));
  const Eigen::Vector2d half_width =
      0.5 * b.width * Eigen::Vector2d(-std::sin(b.yaw), std::cos(b.yaw));
  Polygon polygon;  // b, seen from the centre of a
  polygon.add(offset + half_length + half_width);
  polygon.add(offset - half_length + half_width);
  polygon.add(offset - half_length - half_width);
  polygon.add(offset + half_length - half_width);
  polygon = cut(polygon, along, 0.5 * a.length);
  polygon = cut(polygon, -along, 0.5 * a.length);
  polygon = cut(polygon, across, 0.5 * a.width);
  polygon = cut(polygon, -across, 0.5 * a.width);
  return areaOf(polygon);
}

double overlap2d(const Box2d& a, const Box2d& b) {
  const double both = intersection2d(a, b);
  if (!(both > 0.0)) return 0.0;
  return both / (a.width() * a.height() + b.width() * b.height() - both);
}

double ratioInside(const Box2d& box, const Box2d& region) {
  const double both = intersection2d(box, region);
  return both > 0.0 ? both / (box.width() * box.height()) : 0.0;
}

double overlap3d(const Box3d& a, const Box3d& b) {
  const double top = std::max(a.centre.y() - 0.5 * a.height, b.centre.y() - 0.5 * b.height);
  const double bottom = std::min(a.centre.y() + 0.5 * a.height, b.centre.y() + 0.5 * b.height);
  if (!(bottom > top)) return 0.0;
  const double both = intersectionArea(footprintOf(a), footprintOf(b)) * (bottom - top);
  if (!(both > 0.0)) return 0.0;
  return both / (a.length * a.width * a.height + b.length * b.width * b.height - both);
}

}  // namespace headway
