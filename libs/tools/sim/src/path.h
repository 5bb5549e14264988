// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace headway::sim {

/// A place on a path and the direction the path has there.
struct PathPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< world [m]
  double yaw = 0.0;                                    ///< direction about world z [rad]
};

/// A smooth curve over the ground, known by its arc length s.
///
/// Samples stand 1 m apart and are joined by Catmull-Rom splines, so direction is continuous.
/// A closed path takes every s (modulo its length); an open one ends at 0 and length().
class Path {
 public:
  /// @param points  polyline of at least two distinct points [m]
  /// @param closed  the last point is joined to the first
  explicit Path(const std::vector<Eigen::Vector3d>& points, bool closed = false);

  [[nodiscard]] double length() const { return length_; }
  [[nodiscard]] bool closed() const { return closed_; }
  [[nodiscard]] PathPoint at(double s) const;
  /// The point `left` metres to the left of the path at s.
  [[nodiscard]] Eigen::Vector3d beside(double s, double left) const;
  /// Turn of direction per metre at s [1/m].
  [[nodiscard]] double curvature(double s) const;

  struct Projection {
    double s = 0.0;     ///< [m]
    double left = 0.0;  ///< signed distance to the left [m]
  };
  /// Nearest sample between s_min and s_max, refined within it.
  [[nodiscard]] Projection project(const Eigen::Vector2d& xy, double s_min, double s_max) const;

 private:
  [[nodiscard]] const Eigen::Vector3d& sample(long index) const;

  std::vector<Eigen::Vector3d> samples_;
  double spacing_ = 1.0;
  double length_ = 0.0;
  bool closed_ = false;
};

/// The points of a path moved `left` metres to its left, optionally in the opposite direction.
[[nodiscard]] Path besidePath(const Path& path, double left, bool reversed);

}  // namespace headway::sim
