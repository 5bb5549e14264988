// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/parallel_rows.h>
#include <headway/render/painter.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace headway::render {
namespace {

constexpr int kHiddenShift = 2;  // of the opacity, to a quarter

/// A corner in camera coordinates.
struct Placed {
  Eigen::Vector3f point;  ///< [m]
  float opacity;
};

/// The part of a triangle that is farther away than `near_m`: 0, 3 or 4 corners.
std::size_t clipped(const std::array<Placed, 3>& triangle, float near_m,
                    std::array<Placed, 4>& polygon) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Placed& from = triangle[i];
    const Placed& to = triangle[(i + 1) % 3];
    const bool from_visible = from.point.z() >= near_m;
    if (from_visible) polygon[count++] = from;
    if (from_visible == (to.point.z() >= near_m)) continue;
    const float ratio = (near_m - from.point.z()) / (to.point.z() - from.point.z());
    polygon[count++] = {from.point + ratio * (to.point - from.point),
                        from.opacity + ratio * (to.opacity - from.opacity)};
  }
  return count;
}

/// @param opacity  0 to 256
std::uint8_t blended(int below, int above, int opacity) {
  return static_cast<std::uint8_t>(below + (((above - below) * opacity) >> 8));
}

}  // namespace

void Painter::paint(const std::vector<PaintedTriangle>& triangles, double margin_m) {
  show();
  std::vector<Polygon> polygons(triangles.size());
  forEachRow(static_cast<int>(triangles.size()), [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    polygons[i] = projected(triangles[i]);
  });
  forEachRow(kBands, [&](int index) {
    const Band band = bandOf(index);
    for (const auto& polygon : polygons) fill(polygon, static_cast<float>(margin_m), band);
  });
}

/// The part of a triangle before the camera, without rows if it is in none of the picture.
Painter::Polygon Painter::projected(const PaintedTriangle& triangle) const {
  std::array<Placed, 3> placed;
  for (std::size_t i = 0; i < 3; ++i) {
    placed[i] = {R_camera_map_ * triangle.corners[i] + t_camera_map_, triangle.opacity[i]};
  }
  std::array<Placed, 4> visible;
  Polygon polygon;
  polygon.count = clipped(placed, static_cast<float>(view_.near_m), visible);
  if (polygon.count < 3) return polygon;
  float top = std::numeric_limits<float>::infinity(), bottom = -top;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const float inverse = 1.F / visible[i].point.z();
    Corner& corner = polygon.corners[i];
    corner = {static_cast<float>(view_.fx) * visible[i].point.x() * inverse +
                  static_cast<float>(view_.cx),
              static_cast<float>(view_.fy) * visible[i].point.y() * inverse +
                  static_cast<float>(view_.cy),
              inverse, visible[i].opacity};
    top = std::min(top, corner.v);
    bottom = std::max(bottom, corner.v);
  }
  const auto rowFrom = [&](float v) {
    return static_cast<int>(std::ceil(std::clamp(v, 0.F, static_cast<float>(view_.height))));
  };
  polygon.first_row = rowFrom(top);
  polygon.end_row = rowFrom(bottom);
  polygon.colour = triangle.colour;
  return polygon;
}

/// Row by row between the crossings of the edges; a pixel on a common edge belongs to one of two
/// adjacent polygons.
void Painter::fill(const Polygon& polygon, float margin_m, const Band& band) {
  const int end_row = std::min(polygon.end_row, band.end);
  for (int row = std::max(polygon.first_row, band.first); row < end_row; ++row) {
    const auto v = static_cast<float>(row);
    std::array<Corner, 2> crossings;
    std::size_t count = 0;
    for (std::size_t i = 0; i < polygon.count && count < 2; ++i) {
      const Corner& a = polygon.corners[i];
      const Corner& b = polygon.corners[(i + 1) % polygon.count];
      if ((a.v <= v) == (b.v <= v)) continue;
      const float ratio = (v - a.v) / (b.v - a.v);
      crossings[count++] = {a.u + ratio * (b.u - a.u), v,
                            a.inverse_depth + ratio * (b.inverse_depth - a.inverse_depth),
                            a.opacity + ratio * (b.opacity - a.opacity)};
    }
    if (count < 2) continue;
    const bool ordered = crossings[0].u <= crossings[1].u;
    fillRow(row, crossings[ordered ? 0 : 1], crossings[ordered ? 1 : 0], polygon.colour, margin_m);
  }
}

void Painter::fillRow(int row, Corner left, Corner right, Colour colour, float margin_m) {
  const auto width = static_cast<float>(view_.width);
  const int first = static_cast<int>(std::ceil(std::clamp(left.u, 0.F, width)));
  const int end = static_cast<int>(std::ceil(std::clamp(right.u, 0.F, width)));
  if (first >= end) return;
  const float step = 1.F / std::max(1e-6F, right.u - left.u);
  const float inverse_step = step * (right.inverse_depth - left.inverse_depth);
  const float opacity_step = 256.F * step * (right.opacity - left.opacity);
  const float offset = static_cast<float>(first) - left.u;
  float inverse = left.inverse_depth + offset * inverse_step;
  float opacity = 256.F * left.opacity + offset * opacity_step;  // 0 to 256
  const auto* depth = depths_.ptr<float>(row);
  auto* pixel = colours_.ptr<cv::Vec3b>(row);
  for (int column = first; column < end; ++column) {
    const bool hidden = inverse * (depth[column] + margin_m) < 1.F;
    const int shown = static_cast<int>(opacity) >> (hidden ? kHiddenShift : 0);
    auto& bgr = pixel[column];
    bgr = {blended(bgr[0], colour.blue, shown), blended(bgr[1], colour.green, shown),
           blended(bgr[2], colour.red, shown)};
    inverse += inverse_step;
    opacity += opacity_step;
  }
}

}  // namespace headway::render
