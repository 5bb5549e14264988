// SPDX-License-Identifier: BSD-3-Clause
#include "path.h"

#include <mrpt/core/exceptions.h>

#include <algorithm>
#include <cmath>

namespace headway::sim {
namespace {

std::vector<double> arcLengths(const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> lengths{0.0};
  for (std::size_t i = 1; i < points.size(); ++i) {
    lengths.push_back(lengths.back() + (points[i] - points[i - 1]).norm());
  }
  return lengths;
}

}  // namespace

Path::Path(const std::vector<Eigen::Vector3d>& points, bool closed) : closed_(closed) {
  ASSERTMSG_(points.size() >= 2, "a path needs two points");
  auto polyline = points;
  if (closed) polyline.push_back(points.front());
  const auto arcs = arcLengths(polyline);
  length_ = arcs.back();
  ASSERTMSG_(length_ > 0.0, "a path needs a length");
  const auto intervals = std::max(1L, std::lround(length_));
  spacing_ = length_ / static_cast<double>(intervals);
  std::size_t segment = 0;
  for (long i = 0; i < (closed ? intervals : intervals + 1); ++i) {
    const double s = spacing_ * static_cast<double>(i);
    while (segment + 2 < arcs.size() && arcs[segment + 1] < s) ++segment;
    const double span = std::max(arcs[segment + 1] - arcs[segment], 1e-9);
    const double t = std::clamp((s - arcs[segment]) / span, 0.0, 1.0);
    samples_.push_back((1.0 - t) * polyline[segment] + t * polyline[segment + 1]);
  }
}

const Eigen::Vector3d& Path::sample(long index) const {
  const long n = static_cast<long>(samples_.size());
  if (closed_) return samples_[static_cast<std::size_t>(((index % n) + n) % n)];
  return samples_[static_cast<std::size_t>(std::clamp(index, 0L, n - 1))];
}

PathPoint Path::at(double s) const {
  if (!closed_) s = std::clamp(s, 0.0, length_);
  const double place = s / spacing_;
  long i = static_cast<long>(std::floor(place));
  if (!closed_) i = std::min(i, static_cast<long>(samples_.size()) - 2);
  const double t = place - static_cast<double>(i);
  const Eigen::Vector3d &p1 = sample(i), &p2 = sample(i + 1);
  // Beyond the ends of an open path the curve goes on straight.
  const bool first = !closed_ && i == 0;
  const bool last = !closed_ && i + 2 >= static_cast<long>(samples_.size());
  const Eigen::Vector3d p0 = first ? Eigen::Vector3d(2.0 * p1 - p2) : sample(i - 1);
  const Eigen::Vector3d p3 = last ? Eigen::Vector3d(2.0 * p2 - p1) : sample(i + 2);
  const Eigen::Vector3d a = 2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3;
  const Eigen::Vector3d b = -p0 + 3.0 * p1 - 3.0 * p2 + p3;
  const Eigen::Vector3d tangent = 0.5 * ((p2 - p0) + 2.0 * t * a + 3.0 * t * t * b);
  return {p1 + 0.5 * t * ((p2 - p0) + t * a + t * t * b), std::atan2(tangent.y(), tangent.x())};
}

Eigen::Vector3d Path::beside(double s, double left) const {
  const PathPoint point = at(s);
  return point.position + left * Eigen::Vector3d(-std::sin(point.yaw), std::cos(point.yaw), 0.0);
}

double Path::curvature(double s) const {
  constexpr double kReach = 2.0;
  const double turn = at(s + kReach).yaw - at(s - kReach).yaw;
  return std::remainder(turn, 2.0 * M_PI) / (2.0 * kReach);
}

Path::Projection Path::project(const Eigen::Vector2d& xy, double s_min, double s_max) const {
  const long first = static_cast<long>(std::floor(s_min / spacing_));
  const long last = static_cast<long>(std::ceil(s_max / spacing_));
  long best = first;
  double best_distance = 1e300;
  for (long i = first; i <= last; ++i) {
    const double distance = (sample(i).head<2>() - xy).squaredNorm();
    if (distance < best_distance) {
      best_distance = distance;
      best = i;
    }
  }
  const double s = spacing_ * static_cast<double>(best);
  const PathPoint point = at(s);
  const Eigen::Vector2d offset = xy - point.position.head<2>();
  const Eigen::Vector2d along(std::cos(point.yaw), std::sin(point.yaw));
  return {s + offset.dot(along), offset.y() * along.x() - offset.x() * along.y()};
}

Path besidePath(const Path& path, double left, bool reversed) {
  std::vector<Eigen::Vector3d> points;
  const long count = static_cast<long>(path.length());
  for (long i = 0; i <= (path.closed() ? count - 1 : count); ++i) {
    points.push_back(path.beside(static_cast<double>(i), left));
  }
  if (reversed) std::reverse(points.begin(), points.end());
  return Path(points, path.closed());
}

}  // namespace headway::sim
