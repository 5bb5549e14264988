// SPDX-License-Identifier: BSD-3-Clause
#include <headway/map/track_geometry.h>

#include <algorithm>
#include <cmath>

namespace headway::map {

std::array<Eigen::Vector3d, 8> boxCorners(const Track& track) {
  const Eigen::Vector3d half = 0.5 * track.size;
  const Eigen::Vector3d forward =
      half.x() * Eigen::Vector3d(std::cos(track.yaw), std::sin(track.yaw), 0.0);
  const Eigen::Vector3d left =
      half.y() * Eigen::Vector3d(-std::sin(track.yaw), std::cos(track.yaw), 0.0);
  const Eigen::Vector3d up(0.0, 0.0, half.z());
  std::array<Eigen::Vector3d, 8> corners;
  for (std::size_t level = 0; level < 2; ++level) {
    const Eigen::Vector3d middle = track.position + (level == 0 ? -1.0 : 1.0) * up;
    corners[4 * level + 0] = middle + forward + left;
    corners[4 * level + 1] = middle + forward - left;
    corners[4 * level + 2] = middle - forward - left;
    corners[4 * level + 3] = middle - forward + left;
  }
  return corners;
}

std::vector<Eigen::Vector3d> groundTrail(const Track& track) {
  const Eigen::Vector3d down(0.0, 0.0, -0.5 * track.size.z());
  std::vector<Eigen::Vector3d> trail;
  for (const auto& point : track.recent_path) trail.push_back(point.position + down);
  const Eigen::Vector3d now = track.position + down;
  if (trail.empty() || (trail.back() - now).norm() > 1e-6) trail.push_back(now);
  return trail;
}

std::vector<Eigen::Vector3d> groundPath(const Track& track, const PredictedPath& prediction) {
  const Eigen::Vector3d down(0.0, 0.0, -0.5 * track.size.z());
  std::vector<Eigen::Vector3d> path{track.position + down};
  for (const auto& point : prediction.points) path.push_back(point.position + down);
  return path;
}

double lengthOf(const std::vector<Eigen::Vector3d>& polyline) {
  double length = 0.0;
  for (std::size_t i = 1; i < polyline.size(); ++i)
    length += (polyline[i] - polyline[i - 1]).norm();
  return length;
}

std::vector<std::vector<Eigen::Vector3d>> dashesOf(const std::vector<Eigen::Vector3d>& polyline,
                                                   double dash, double gap) {
  std::vector<std::vector<Eigen::Vector3d>> dashes;
  bool drawing = false;
  double left_to_switch = 0.0;  // the path starts with a dash
  for (std::size_t i = 1; i < polyline.size(); ++i) {
    Eigen::Vector3d from = polyline[i - 1];
    double remaining = (polyline[i] - from).norm();
    const Eigen::Vector3d direction = remaining > 0.0
                                          ? Eigen::Vector3d((polyline[i] - from) / remaining)
                                          : Eigen::Vector3d::Zero();
    while (remaining > 0.0) {
      if (left_to_switch <= 0.0) {
        drawing = !drawing;
        left_to_switch = drawing ? dash : gap;
        if (drawing) dashes.push_back({from});
      }
      const double step = std::min(left_to_switch, remaining);
      from += step * direction;
      if (drawing) dashes.back().push_back(from);
      left_to_switch -= step;
      remaining -= step;
    }
  }
  return dashes;
}

}  // namespace headway::map
