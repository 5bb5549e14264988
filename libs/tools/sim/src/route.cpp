// SPDX-License-Identifier: BSD-3-Clause
// The street that the robot drives along, and its cross-section.
#include "route.h"

#include <headway/core/error.h>
#include <headway/io/trajectory_file.h>
#include <mrpt/core/exceptions.h>

#include <algorithm>
#include <cmath>
#include <sstream>

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

namespace {

constexpr double kStep = 0.5;     // [m]
constexpr double kBefore = 60.0;  // street before the start [m]
constexpr double kAfter = 200.0;  // street after the end [m]

/// Curvature at every kStep of a shape such as "straight 60, left 40 90".
std::vector<double> parseShape(const std::string& shape) {
  std::vector<double> curvatures;
  std::istringstream parts(shape);
  for (std::string part; std::getline(parts, part, ',');) {
    std::istringstream words(part);
    std::string kind;
    double first = 0.0, degrees = 0.0;
    words >> kind >> first;
    const bool turn = kind == "left" || kind == "right";
    if (turn) words >> degrees;
    if ((!turn && kind != "straight") || words.fail() || first <= 0.0 ||
        (turn && (first < 8.0 || degrees <= 0.0 || degrees > 360.0))) {
      throw InputError("[route] shape: '" + part +
                       "' is none of 'straight METRES', 'left RADIUS DEGREES', 'right RADIUS "
                       "DEGREES' with a radius of at least 8 m and at most 360 degrees");
    }
    const double length = turn ? first * degrees * M_PI / 180.0 : first;
    const double curvature = !turn ? 0.0 : (kind == "left" ? 1.0 : -1.0) / first;
    curvatures.insert(curvatures.end(),
                      static_cast<std::size_t>(std::max(1L, std::lround(length / kStep))),
                      curvature);
  }
  if (curvatures.empty()) throw InputError("[route] shape: is empty");
  return curvatures;
}

/// Transitions between straight and curve over some metres, as roads have.
std::vector<double> eased(const std::vector<double>& values, int reach) {
  std::vector<double> result(values.size());
  const int n = static_cast<int>(values.size());
  for (int i = 0; i < n; ++i) {
    double sum = 0.0;
    for (int k = -reach; k <= reach; ++k)
      sum += values[static_cast<std::size_t>(std::clamp(i + k, 0, n - 1))];
    result[static_cast<std::size_t>(i)] = sum / (2 * reach + 1);
  }
  return result;
}

double hill(double s, double height) {
  return height * 0.5 * (std::sin(s / 53.0) - 0.5 * std::sin(s / 31.0 + 1.0) + 0.5 * std::sin(1.0));
}

Route makeLane(const RouteParams& params, double hill_height) {
  std::vector<double> curvatures(static_cast<std::size_t>(kBefore / kStep), 0.0);
  const auto shape = parseShape(params.shape);
  curvatures.insert(curvatures.end(), shape.begin(), shape.end());
  curvatures.insert(curvatures.end(), static_cast<std::size_t>(kAfter / kStep), 0.0);
  curvatures = eased(curvatures, 8);
  std::vector<Eigen::Vector3d> points;
  Eigen::Vector3d at(-kBefore, 0.0, 0.0);
  double yaw = 0.0, s = -kBefore;
  for (const double curvature : curvatures) {
    points.push_back(at + Eigen::Vector3d(0, 0, hill(s, hill_height)));
    yaw += 0.5 * curvature * kStep;
    at += kStep * Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0);
    yaw += 0.5 * curvature * kStep;
    s += kStep;
  }
  Route route{Path(points)};
  route.start_s = kBefore;
  route.end_s = route.street.length() - kAfter;
  route.robot_left = -kStreet.lane_middle;
  return route;
}

Route makeLoop(const RouteParams& params, double hill_height) {
  // A rectangle with round corners, driven to the left, from the middle of its lower side.
  const double r = params.corner_radius_m;
  const double w = params.loop_length_m - 2 * r, h = params.loop_width_m - 2 * r;
  std::vector<Eigen::Vector3d> points;
  Eigen::Vector3d at(0, 0, 0);
  double yaw = 0.0;
  const auto straight = [&](double length) {
    const long steps = std::max(1L, std::lround(length / kStep));
    for (long i = 0; i < steps && length > 0.0; ++i) {
      points.push_back(at);
      at += length / static_cast<double>(steps) * Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0);
    }
  };
  const auto corner = [&] {
    const long steps = std::lround(0.5 * M_PI * r / kStep);
    for (long i = 0; i < steps; ++i) {
      points.push_back(at);
      const double turn = 0.5 * M_PI / static_cast<double>(steps);
      const double chord = 2.0 * r * std::sin(0.5 * turn);
      at += chord * Eigen::Vector3d(std::cos(yaw + 0.5 * turn), std::sin(yaw + 0.5 * turn), 0);
      yaw += turn;
    }
  };
  straight(0.5 * w);
  for (const double side : {h, w, h}) {
    corner();
    straight(side);
  }
  corner();
  straight(0.5 * w);
  for (auto& point : points) {
    point.z() = 0.5 * hill_height * (std::cos(point.x() / 40.0) * std::cos(point.y() / 30.0) - 1.0);
  }
  Route route{Path(points, true)};
  route.end_s = route.street.length() * params.laps;
  route.robot_left = -kStreet.lane_middle;
  return route;
}

/// Takes the jitter out of the heights: mean over some metres before and behind.
void smoothHeights(std::vector<Eigen::Vector3d>& points) {
  std::vector<double> heights;
  for (const auto& point : points) heights.push_back(point.z());
  constexpr int kReach = 12;  // [m], as points stand about a metre apart
  heights = eased(eased(heights, kReach), kReach);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].z() = heights[i];
}

/// Where a path comes by an earlier place, the ground is at the height that it had then.
void levelRevisits(std::vector<Eigen::Vector3d>& points) {
  // Points stand about a metre apart.
  const auto later = static_cast<std::size_t>(kStreet.revisit_after);
  for (std::size_t i = later; i < points.size(); ++i) {
    double nearest = kStreet.same_street * kStreet.same_street;
    for (std::size_t k = 0; k + later < i; ++k) {
      const double distance = (points[i] - points[k]).head<2>().squaredNorm();
      if (distance >= nearest) continue;
      nearest = distance;
      points[i].z() = points[k].z();
    }
  }
}

/// Throws if a path leaves the world: the ground that streets can be laid on.
void requireDrivable(const std::vector<Eigen::Vector3d>& points, const std::string& file) {
  const auto refuse = [&](const Eigen::Vector3d& at, const std::string& what) {
    std::ostringstream text;
    text << "[route] file: " << file << ": at x " << at.x() << " m, y " << at.y() << " m, z "
         << at.z() << " m (forward, left, up) the path " << what;
    throw InputError(text.str());
  };
  constexpr std::size_t kReach = 10;
  for (std::size_t i = kReach; i < points.size(); ++i) {
    const Eigen::Vector3d way = points[i] - points[i - kReach];
    // San Francisco's steepest street rises by 0.31.
    if (std::abs(way.z()) > 0.35 * way.head<2>().norm() + 1.0) {
      refuse(points[i], "leaves the ground: steeper than 35 %; are these camera poses, y down?");
    }
  }
}

/// Robot positions of a KITTI path, where it moved by at least a metre.
std::vector<Eigen::Vector3d> readKittiPositions(const std::string& file) {
  std::vector<Eigen::Vector3d> positions;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  std::size_t row = 0;
  for (const Pose& pose : io::readKittiPoses(file)) {
    ++row;
    const Eigen::Vector3d at = robotFromOptical() * pose.translation();
    if (!at.allFinite() || (row > 1 && (at - last).norm() > 10.0)) {
      throw InputError("[route] file: " + file + ": row " + std::to_string(row) +
                       " leaves the path by more than 10 m; no street leads there");
    }
    last = at;
    if (positions.empty() || (at - positions.back()).head<2>().norm() >= 1.0) {
      positions.push_back(at);
    }
  }
  if (positions.size() < 5) {
    throw InputError("[route] file: " + file + " has less than 5 m of path");
  }
  return positions;
}

/// Robot positions of a KITTI path, smoothed.
std::vector<Eigen::Vector3d> readKittiPath(const std::string& file) {
  std::vector<Eigen::Vector3d> raw = readKittiPositions(file);
  std::vector<Eigen::Vector3d> smooth = raw;
  for (int pass = 0; pass < 4; ++pass) {
    for (std::size_t i = 1; i + 1 < smooth.size(); ++i) {
      raw[i] = 0.25 * smooth[i - 1] + 0.5 * smooth[i] + 0.25 * smooth[i + 1];
    }
    smooth = raw;
  }
  smoothHeights(smooth);
  requireDrivable(smooth, file);
  levelRevisits(smooth);
  smoothHeights(smooth);
  return smooth;
}

Route makeKitti(const RouteParams& params) {
  auto points = readKittiPath(params.file);
  const auto extend = [&](double length, bool front) {
    const auto n = points.size();
    Eigen::Vector3d direction = front ? points[0] - points[2] : points[n - 1] - points[n - 3];
    direction.z() = 0.0;
    direction.normalize();
    const Eigen::Vector3d from = front ? points.front() : points.back();
    std::vector<Eigen::Vector3d> more;
    for (double d = 1.0; d <= length; d += 1.0) more.push_back(from + d * direction);
    if (front) std::reverse(more.begin(), more.end());
    points.insert(front ? points.begin() : points.end(), more.begin(), more.end());
  };
  extend(kBefore, true);
  extend(kAfter, false);
  // The robot drives on the right: the middle of the street is to the left of its path.
  Route route{besidePath(Path(points), kStreet.lane_middle, false)};
  route.start_s = kBefore;
  route.end_s = route.street.length() - kAfter;
  route.robot_left = -kStreet.lane_middle;
  return route;
}

Route withinWorld(Route route, const std::string& key) {
  if (route.street.length() > 40e3) {
    throw InputError("[route] " + key + ": the path leaves the world: it is " +
                     std::to_string(static_cast<long>(route.end_s - route.start_s)) +
                     " m long, and streets end after 40 km");
  }
  return route;
}

}  // namespace

Route makeRoute(const RouteParams& params, double hill_height_m) {
  switch (params.kind) {
    case RouteParams::Kind::kLoop:
      return makeLoop(params, hill_height_m);
    case RouteParams::Kind::kKittiPoses:
      return withinWorld(makeKitti(params), "file");
    case RouteParams::Kind::kLane:
      break;
  }
  return withinWorld(makeLane(params, hill_height_m), "shape");
}

}  // namespace headway::sim
