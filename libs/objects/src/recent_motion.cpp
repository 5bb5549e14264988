// SPDX-License-Identifier: BSD-3-Clause
#include "recent_motion.h"

#include <algorithm>
#include <cmath>

namespace headway::objects {

Eigen::Vector2d placeAt(const std::vector<TrajectoryPoint>& path, Time time) {
  const std::size_t last = path.size() - 1;
  if (last == 0 || time <= path.front().time) return path.front().position.head<2>();
  // The index is estimated first, since samples mostly have a constant rate.
  const double steps = static_cast<double>(last) / (path.back().time - path.front().time);
  const double estimate = (time - path.front().time) * steps;
  std::size_t later = std::min(last, static_cast<std::size_t>(std::max(1.0, estimate + 0.5)));
  while (later < last && path[later].time < time) ++later;
  while (later > 1 && path[later - 1].time >= time) --later;
  const TrajectoryPoint& a = path[later - 1];
  const TrajectoryPoint& b = path[later];
  const double fraction = std::min(1.0, (time - a.time) / (b.time - a.time));
  return a.position.head<2>() + fraction * (b.position - a.position).head<2>();
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
