// SPDX-License-Identifier: BSD-3-Clause
// The street that the robot drives along, and its cross-section.
#pragma once

#include <headway/sim/sim_params.h>

#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace headway::sim {

/// Cross-section of every street, from its middle outwards [m].
///
/// Two lanes, a strip for cyclists beside each, parking along the kerbs, raised pavements.
struct StreetProfile {
  double lane = 3.3;         ///< width of a lane
  double carriageway = 6.4;  ///< middle to kerb: lane, cycling, parking
  double kerb_height = 0.12;
  double pavement = 2.8;                 ///< width of a pavement
  double edge = carriageway + pavement;  ///< middle to outer pavement edge
  double lane_middle = lane / 2.0;       ///< middle of street to middle of lane
  double cycling = 3.85;                 ///< middle of street to a cyclist
  double parking = 5.35;                 ///< middle of street to a parked car
  double same_street = 7.0;              ///< streets whose middles are nearer than this are one
  double revisit_after = 40.0;           ///< of path, from which on a place is another visit
};
inline constexpr StreetProfile kStreet{};

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

/// The street that the robot drives along: its middle line, and the part that is driven.
struct Route {
  Path street;           ///< goes on beyond both ends of an open drive, so that the view is filled
  double start_s = 0.0;  ///< [m]
  double end_s = 0.0;    ///< [m]; of a closed street beyond its length if there are several laps
  double robot_left = 0.0;  ///< where the robot drives, to the left of the middle line [m]

  /// Way from one place on the street to another; the shorter way round a closed one [m].
  [[nodiscard]] double ahead(double from, double to) const {
    return street.closed() ? std::remainder(to - from, street.length()) : to - from;
  }
};

/// @throws InputError naming the key of a shape or file that cannot be used
[[nodiscard]] Route makeRoute(const RouteParams& params, double hill_height_m);

}  // namespace headway::sim
