// SPDX-License-Identifier: BSD-3-Clause
// Boxes, trails and predicted paths of tracks as geometry to draw.
#include <headway/map/track_geometry.h>
#include <mrpt/opengl/CSetOfTriangles.h>

#include <algorithm>
#include <cmath>
#include <utility>

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

namespace {

/// Horizontal normals of a polyline, at each point of the line between its two neighbours.
std::vector<Eigen::Vector3d> levelNormals(const std::vector<Eigen::Vector3d>& polyline) {
  std::vector<Eigen::Vector3d> normals(polyline.size(), Eigen::Vector3d::UnitY());
  for (std::size_t i = 0; i < polyline.size(); ++i) {
    const auto& before = polyline[i == 0 ? 0 : i - 1];
    const auto& after = polyline[std::min(i + 1, polyline.size() - 1)];
    const Eigen::Vector2d way = (after - before).head<2>();
    if (way.norm() > 1e-9) {
      normals[i] = Eigen::Vector3d(-way.y(), way.x(), 0.0) / way.norm();
    } else if (i > 0) {
      normals[i] = normals[i - 1];
    }
  }
  return normals;
}

mrpt::opengl::TTriangle::Vertex vertexAt(const Eigen::Vector3d& point, Colour colour,
                                         double opacity) {
  mrpt::opengl::TTriangle::Vertex vertex;
  vertex.xyzrgba.pt = {static_cast<float>(point.x()), static_cast<float>(point.y()),
                       static_cast<float>(point.z())};
  vertex.setColor({colour.red, colour.green, colour.blue,
                   static_cast<std::uint8_t>(std::clamp(opacity, 0.0, 255.0))});
  vertex.normal = {0.f, 0.f, 1.f};
  return vertex;
}

}  // namespace

void appendRibbon(const std::vector<Eigen::Vector3d>& polyline, const HalfWidths& half_widths,
                  Colour colour, const Fade& opacity, mrpt::opengl::CSetOfTriangles& out) {
  if (polyline.size() < 2) return;
  const auto normals = levelNormals(polyline);
  const double last = static_cast<double>(polyline.size() - 1);
  const auto edgesAt = [&](std::size_t i) {
    const Eigen::Vector3d aside = half_widths[i] * normals[i];
    const double shown = opacity(static_cast<double>(i) / last);
    return std::make_pair(vertexAt(polyline[i] + aside, colour, shown),
                          vertexAt(polyline[i] - aside, colour, shown));
  };
  std::vector<mrpt::opengl::TTriangle> triangles(2 * (polyline.size() - 1));
  auto before = edgesAt(0);
  for (std::size_t i = 1; i < polyline.size(); ++i) {
    const auto after = edgesAt(i);
    triangles[2 * i - 2].vertices = {before.first, before.second, after.second};
    triangles[2 * i - 1].vertices = {before.first, after.second, after.first};
    before = after;
  }
  out.insertTriangles(triangles.begin(), triangles.end());
}

void appendRibbon(const std::vector<Eigen::Vector3d>& polyline, double width, Colour colour,
                  double opacity, mrpt::opengl::CSetOfTriangles& out) {
  appendRibbon(
      polyline, HalfWidths(polyline.size(), 0.5 * width), colour,
      [opacity](double) { return opacity; }, out);
}

}  // namespace headway::map
