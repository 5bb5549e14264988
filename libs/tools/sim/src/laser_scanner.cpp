// SPDX-License-Identifier: BSD-3-Clause
#include "laser_scanner.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace headway::sim {

LaserScanner::LaserScanner(const LaserParams& params, std::uint64_t seed)
    : params_(params), random_(seed) {
  T_robot_laser_.translation() = Eigen::Vector3d(params.forward_m, 0.0, params.height_m);
}

void LaserScanner::addSegment(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                              std::vector<double>& ranges) const {
  const double aperture = params_.aperture_deg * M_PI / 180.0;
  const auto last = static_cast<double>(ranges.size() - 1);
  const double step = aperture / last;
  double from = std::atan2(a.y(), a.x()), to = std::atan2(b.y(), b.x());
  if (std::abs(from - to) > M_PI) (from < to ? from : to) += 2.0 * M_PI;  // across the back
  if (from > to) std::swap(from, to);
  const Eigen::Vector2d along = b - a;
  for (const double turn : {0.0, -2.0 * M_PI}) {
    const double first_ray = std::ceil((from + turn + 0.5 * aperture) / step);
    const double last_ray = std::floor((to + turn + 0.5 * aperture) / step);
    for (double i = std::max(0.0, first_ray); i <= std::min(last, last_ray); i += 1.0) {
      const double angle = i * step - 0.5 * aperture;
      const Eigen::Vector2d ray(std::cos(angle), std::sin(angle));
      const double across = ray.x() * along.y() - ray.y() * along.x();
      if (std::abs(across) < 1e-12) continue;
      const double range = (a.x() * along.y() - a.y() * along.x()) / across;
      double& nearest = ranges[static_cast<std::size_t>(i)];
      if (range > 0.0) nearest = std::min(nearest, range);
    }
  }
}

void LaserScanner::cut(const std::array<Eigen::Vector3d, 3>& triangle,
                       std::vector<double>& ranges) const {
  std::array<Eigen::Vector2d, 2> ends;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d &p = triangle[i], &q = triangle[(i + 1) % 3];
    if ((p.z() > 0.0) == (q.z() > 0.0)) continue;
    const double ratio = p.z() / (p.z() - q.z());
    ends[count++] = (p + ratio * (q - p)).head<2>();
  }
  if (count == 2) addSegment(ends[0], ends[1], ranges);
}

LaserScan LaserScanner::scan(Time time, const Pose& T_world_robot,
                             const std::vector<PlacedMesh>& statics,
                             const std::vector<Mesh>& actor_meshes) {
  const Pose T_laser_world = (T_world_robot * T_robot_laser_).inverse();
  std::vector<double> ranges(static_cast<std::size_t>(params_.rays),
                             std::numeric_limits<double>::infinity());
  const auto add = [&](const Mesh& mesh, const Eigen::Vector3d& anchor) {
    const Pose T_laser_mesh = T_laser_world * Eigen::Translation3d(anchor);
    for (const auto& triangle : mesh.triangles) {
      cut({T_laser_mesh * triangle[0].position.cast<double>(),
           T_laser_mesh * triangle[1].position.cast<double>(),
           T_laser_mesh * triangle[2].position.cast<double>()},
          ranges);
    }
  };
  for (const PlacedMesh& placed : statics) add(*placed.mesh, placed.anchor);
  for (const Mesh& mesh : actor_meshes) add(mesh, T_world_robot.translation());
  LaserScan scan;
  scan.time = time;
  scan.T_robot_laser = T_robot_laser_;
  scan.aperture_rad = params_.aperture_deg * M_PI / 180.0;
  scan.max_range_m = params_.max_range_m;
  scan.sigma_m = params_.sigma_m;
  for (const double range : ranges) {
    const double measured = range + params_.sigma_m * random_.normal();
    const bool lost = random_.chance(params_.miss_ratio);
    const bool valid = !lost && range >= params_.min_range_m && measured < params_.max_range_m;
    scan.ranges.push_back(valid ? static_cast<float>(measured) : 0.0F);
  }
  return scan;
}

}  // namespace headway::sim
