// SPDX-License-Identifier: BSD-3-Clause
#include "recent_motion.h"

#include <algorithm>
#include <cmath>

namespace headway::objects {

Eigen::Vector2d placeAt(const std::vector<TrajectoryPoint>& path, Time time) {
  return positionAt(path, time).head<2>();
}

double spanOf(const std::vector<TrajectoryPoint>& path) {
  return path.size() < 2 ? 0.0 : path.back().time - path.front().time;
}

Eigen::Vector2d recentVelocity(const std::vector<TrajectoryPoint>& path, double window_s) {
  const double window = std::min(window_s, spanOf(path));
  if (window <= 0.0) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d now = path.back().position.head<2>();
  return (now - placeAt(path, path.back().time - window)) / window;
}

Eigen::Vector2d unitOr(const Eigen::Vector2d& direction, const Eigen::Vector2d& fallback) {
  const double length = direction.norm();
  return length > kNoDirection_m ? Eigen::Vector2d(direction / length) : fallback;
}

}  // namespace headway::objects
