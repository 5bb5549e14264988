// SPDX-License-Identifier: BSD-3-Clause
#include <headway/map/ribbon.h>
#include <mrpt/opengl/CSetOfTriangles.h>

#include <algorithm>
#include <utility>

namespace headway::map {
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
