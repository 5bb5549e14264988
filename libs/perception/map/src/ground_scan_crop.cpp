// SPDX-License-Identifier: BSD-3-Clause
#include "ground_scan_crop.h"

#include <algorithm>
#include <optional>

namespace headway::map {
namespace {

/// The part of a segment of ground within a rectangle of the map; nullopt if there is none.
///
/// @see  Liang & Barsky 1984, "A new concept and method for line clipping"
std::optional<GroundScan::Free> clipped(const GroundScan::Free& piece, const Pose& T_map_robot,
                                        const Eigen::AlignedBox2d& area) {
  const Eigen::Vector2d from = (T_map_robot * piece.from.cast<double>()).head<2>();
  const Eigen::Vector2d way = (T_map_robot * piece.to.cast<double>()).head<2>() - from;
  double first = 0.0;
  double last = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    const double low = area.min()[axis] - from[axis];
    const double high = area.max()[axis] - from[axis];
    if (way[axis] == 0.0) {
      if (low > 0.0 || high < 0.0) return std::nullopt;
      continue;
    }
    first = std::max(first, std::min(low / way[axis], high / way[axis]));
    last = std::min(last, std::max(low / way[axis], high / way[axis]));
  }
  if (first > last) return std::nullopt;
  const Eigen::Vector3f along = piece.to - piece.from;
  return GroundScan::Free{piece.from + static_cast<float>(first) * along,
                          piece.from + static_cast<float>(last) * along};
}

}  // namespace

GroundScan cropped(const GroundScan& scan, const Pose& T_map_robot,
                   const Eigen::AlignedBox2d& area) {
  GroundScan inside;
  const auto add_free = [&](const auto& from, auto& to) {
    for (const auto& piece : from) {
      if (const auto part = clipped(piece, T_map_robot, area)) to.push_back(*part);
    }
  };
  const auto add_obstacles = [&](const auto& from, auto& to) {
    for (const auto& obstacle : from) {
      const Eigen::Vector2d foot =
          (T_map_robot * obstacle.foot.template cast<double>()).template head<2>();
      if (area.contains(foot)) to.push_back(obstacle);
    }
  };
  add_free(scan.free, inside.free);
  add_free(scan.laser_passed, inside.laser_passed);
  add_obstacles(scan.obstacles, inside.obstacles);
  add_obstacles(scan.laser_obstacles, inside.laser_obstacles);
  return inside;
}

}  // namespace headway::map
