#include "box_overlap.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace headway::objects {
namespace {

// A convex polygon of at most eight corners: what is left of a rectangle clipped by another.
struct Polygon {
  std::array<Eigen::Vector2d, 16> corners;
  int size = 0;

  void add(const Eigen::Vector2d& corner) { corners[size++] = corner; }

  [[nodiscard]] double area() const {
    double twice = 0.0;
    for (int i = 0; i < size; ++i) {
      const Eigen::Vector2d& a = corners[i];
      const Eigen::Vector2d& b = corners[(i + 1) % size];
      twice += a.x() * b.y() - a.y() * b.x();
    }
    return 0.5 * std::abs(twice);
  }
};

// The part of a polygon on the inner side of a line (Sutherland & Hodgman 1974).
Polygon clipped(const Polygon& polygon, const Eigen::Vector2d& normal, double limit) {
  Polygon result;
  for (int i = 0; i < polygon.size; ++i) {
    const Eigen::Vector2d& a = polygon.corners[i];
    const Eigen::Vector2d& b = polygon.corners[(i + 1) % polygon.size];
    const double over_a = normal.dot(a) - limit;
    const double over_b = normal.dot(b) - limit;
    if (over_a <= 0.0) result.add(a);
    if ((over_a < 0.0 && over_b > 0.0) || (over_a > 0.0 && over_b < 0.0)) {
      result.add(a + over_a / (over_a - over_b) * (b - a));
    }
  }
  return result;
}

double footprintIntersection(const MeasuredBox& a, const MeasuredBox& b) {
  const Eigen::Vector2d forward(std::cos(a.yaw), std::sin(a.yaw));
  const Eigen::Vector2d left(-forward.y(), forward.x());
  const Eigen::Vector2d b_forward(std::cos(b.yaw), std::sin(b.yaw));
  const Eigen::Vector2d b_left(-b_forward.y(), b_forward.x());
  const Eigen::Vector2d offset = (b.position - a.position).head<2>();
  Polygon polygon;  // of b, seen from a's centre
  for (const auto& [along, across] :
       {std::pair(0.5, 0.5), {-0.5, 0.5}, {-0.5, -0.5}, {0.5, -0.5}}) {
    polygon.add(offset + along * b.size.x() * b_forward + across * b.size.y() * b_left);
  }
  polygon = clipped(polygon, forward, 0.5 * a.size.x());
  polygon = clipped(polygon, -forward, 0.5 * a.size.x());
  polygon = clipped(polygon, left, 0.5 * a.size.y());
  polygon = clipped(polygon, -left, 0.5 * a.size.y());
  return polygon.area();
}

}  // namespace

double overlap2d(const Box2d& a, const Box2d& b) {
  const double width = std::min(a.right, b.right) - std::max(a.left, b.left);
  const double height = std::min(a.bottom, b.bottom) - std::max(a.top, b.top);
  if (!(width > 0.0 && height > 0.0)) return 0.0;
  const double both = width * height;
  return both / (a.width() * a.height() + b.width() * b.height() - both);
}

double overlap3d(const MeasuredBox& a, const MeasuredBox& b) {
  const double reach = 0.5 * (a.size.head<2>().norm() + b.size.head<2>().norm());
  if ((a.position - b.position).head<2>().squaredNorm() > reach * reach) return 0.0;
  const double bottom =
      std::max(a.position.z() - 0.5 * a.size.z(), b.position.z() - 0.5 * b.size.z());
  const double top = std::min(a.position.z() + 0.5 * a.size.z(), b.position.z() + 0.5 * b.size.z());
  if (!(top > bottom)) return 0.0;
  const double both = footprintIntersection(a, b) * (top - bottom);
  return both / (a.size.prod() + b.size.prod() - both);
}

}  // namespace headway::objects
