// SPDX-License-Identifier: BSD-3-Clause
// Points and triangles to a picture, without OpenGL.
#include <headway/core/parallel_rows.h>
#include <headway/render/painter.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

namespace headway::render {
namespace {

constexpr float kNoDepth = 1e9F;  // [m]

/// How sky, ground and edges are shaded.
struct Shading {
  float edge = 1.2F;         ///< darkening by the ratio of the distance behind an edge
  float min_light = 0.4F;    ///< behind an edge
  float full_light = 0.96F;  ///< from which a surface is not an edge
  double zenith_sin = 0.5;   ///< sine of the elevation with the zenith's colour
  double ground_sin = 0.12;  ///< sine of the depression with the ground's colour
};
constexpr Shading kShading{};

cv::Vec3b bgrOf(std::uint32_t colour) {
  return {static_cast<std::uint8_t>(colour), static_cast<std::uint8_t>(colour >> 8),
          static_cast<std::uint8_t>(colour >> 16)};
}

cv::Vec3b mixed(const Colour& from, const Colour& to, double ratio) {
  const double part = std::clamp(ratio, 0.0, 1.0);
  const auto mix = [&](std::uint8_t a, std::uint8_t b) {
    return cv::saturate_cast<std::uint8_t>(a + part * (b - a));
  };
  return {mix(from.blue, to.blue), mix(from.green, to.green), mix(from.red, to.red)};
}

cv::Vec3b darkened(const cv::Vec3b& colour, float light) {
  if (light > kShading.full_light) return colour;
  const auto dark = [&](int channel) {
    return static_cast<std::uint8_t>(light * static_cast<float>(colour[channel]));
  };
  return {dark(0), dark(1), dark(2)};
}

/// Factors of a row's brightness by the depths around: less than 1 behind nearer neighbours.
///
/// @param reach  to the neighbours [px]; pixels nearer to the left or right edge are not shaded
void lightOfRow(const cv::Mat& depths, int row, int reach, float* light) {
  const auto* here = depths.ptr<float>(row);
  const auto* up = depths.ptr<float>(std::max(0, row - reach));
  const auto* down = depths.ptr<float>(std::min(depths.rows - 1, row + reach));
  for (int column = reach; column < depths.cols - reach; ++column) {  // without branches: vectors
    const float z = here[column];
    const float left = here[column - reach], right = here[column + reach];
    const float nearer = std::max(0.F, z - left) + std::max(0.F, z - right) +
                         std::max(0.F, z - up[column]) + std::max(0.F, z - down[column]);
    const float shaded = std::max(kShading.min_light, 1.F - kShading.edge * nearer / z);
    light[column] = z < kNoDepth ? shaded : 1.F;
  }
}

}  // namespace

PinholeView enlarged(const PinholeView& view, int factor) {
  PinholeView large = view;
  large.width *= factor;
  large.height *= factor;
  large.fx *= factor;
  large.fy *= factor;
  large.cx = (view.cx + 0.5) * factor - 0.5;
  large.cy = (view.cy + 0.5) * factor - 0.5;
  return large;
}

Painter::Painter(int width, int height)
    : colours_(height, width, CV_8UC3),
      points_(height, width + kRowMargin, CV_32S),
      depths_(height, width + kRowMargin, CV_32F) {
  points_ = points_.colRange(0, width);
  depths_ = depths_.colRange(0, width);
}

Painter::Band Painter::bandOf(int index) const {
  return {view_.height * index / kBands, view_.height * (index + 1) / kBands};
}

void Painter::clear(const PinholeView& view, const Backdrop& backdrop) {
  CV_Assert(view.width == colours_.cols && view.height == colours_.rows);
  view_ = view;
  const Pose T_camera_map = view.T_map_camera.inverse();
  R_camera_map_ = T_camera_map.linear().cast<float>();
  t_camera_map_ = T_camera_map.translation().cast<float>();
  forEachRow(colours_.rows, [&](int row) {
    std::fill_n(depths_.ptr<float>(row), depths_.cols, kNoDepth);
    const Eigen::Vector3d ray =
        view.T_map_camera.linear() * Eigen::Vector3d(0.0, (row - view.cy) / view.fy, 1.0);
    const double up = ray.z() / ray.norm();
    const auto colour = up < 0.0
                            ? mixed(backdrop.horizon, backdrop.ground, -up / kShading.ground_sin)
                            : mixed(backdrop.horizon, backdrop.zenith, up / kShading.zenith_sin);
    std::fill_n(colours_.ptr<cv::Vec3b>(row), colours_.cols, colour);
  });
  shown_ = true;
}

/// Copies the colours of the points to the picture.
///
/// @param light  factor of the colours of a row
template <class Light>
void Painter::showRow(int row, const Light& light) {
  const auto* depth = depths_.ptr<float>(row);
  const auto* point = points_.ptr<std::uint32_t>(row);
  auto* pixel = colours_.ptr<cv::Vec3b>(row);
  for (int column = 0; column < colours_.cols; ++column) {
    if (depth[column] < kNoDepth) pixel[column] = light(column, bgrOf(point[column]));
  }
}

void Painter::show() {
  if (shown_) return;
  forEachRow(colours_.rows,
             [&](int row) { showRow(row, [](int, const cv::Vec3b& colour) { return colour; }); });
  shown_ = true;
}

void Painter::shade() {
  const int reach = std::max(1, view_.height / 500);
  forEachRow(colours_.rows, [&](int row) {
    std::vector<float> light(static_cast<std::size_t>(colours_.cols), 1.F);
    lightOfRow(depths_, row, reach, light.data());
    showRow(row, [&](int column, const cv::Vec3b& colour) {
      return darkened(colour, light[static_cast<std::size_t>(column)]);
    });
  });
  shown_ = true;
}

bool Painter::hides(const Eigen::Vector3d& place_map, double margin_m) const {
  const auto pixel = project(place_map, view_);
  if (!pixel || pixel->cwiseAbs().maxCoeff() > 1e6) return false;
  const int column = static_cast<int>(std::lround(pixel->x()));
  const int row = static_cast<int>(std::lround(pixel->y()));
  if (column < 0 || row < 0 || column >= depths_.cols || row >= depths_.rows) return false;
  const Eigen::Vector3d place = view_.T_map_camera.inverse() * place_map;
  return static_cast<double>(depths_.at<float>(row, column)) < place.z() - margin_m;
}

namespace {

constexpr float kOverlap = 1.5F;    // of neighbouring discs, which are seen at an angle
constexpr float kMinRound = 2.5F;   // radius from which points are discs [px]
constexpr std::size_t kBlock = 64;  // points that are projected together

/// Four pixels, by the vectors of GCC and Clang.
using Floats = float __attribute__((vector_size(16)));
using Words = std::uint32_t __attribute__((vector_size(16)));

std::uint32_t packed(const Colour& colour) {
  return static_cast<std::uint32_t>(colour.red << 16 | colour.green << 8 | colour.blue);
}

/// The first row or column whose centre is not before a place in the picture or near it.
int rowFrom(float place) {
  const int towards_zero = static_cast<int>(place);
  return towards_zero + (static_cast<float>(towards_zero) < place ? 1 : 0);
}

/// Paints the pixels of a row that are within a distance of its centre, and where nothing nearer is
/// painted; four at a time, without branches.
///
/// @param centre         of the painted pixels [px]
/// @param square_radius  of their centres, which are nearer [px^2]
/// @param first, end     what may be painted [px]; up to three more pixels are written unchanged
void paintRow(float z, std::uint32_t colour, float centre, float square_radius, int first, int end,
              float* depths, std::uint32_t* colours) {
  const float offset = static_cast<float>(first) - centre;
  Floats across{offset, offset + 1.F, offset + 2.F, offset + 3.F};
  const Floats new_depths{z, z, z, z};
  const Words new_colours{colour, colour, colour, colour};
  for (int column = first; column < end; column += 4) {
    Floats old_depths;
    Words old_colours;
    std::memcpy(&old_depths, depths + column, sizeof old_depths);
    std::memcpy(&old_colours, colours + column, sizeof old_colours);
    const auto is_painted = (new_depths < old_depths) & (across * across < square_radius);
    old_depths = is_painted ? new_depths : old_depths;
    old_colours = is_painted ? new_colours : old_colours;
    std::memcpy(depths + column, &old_depths, sizeof old_depths);
    std::memcpy(colours + column, &old_colours, sizeof old_colours);
    across += 4.F;
  }
}

}  // namespace

/// Where points of a block are in the picture.
struct Painter::Projected {
  std::array<float, kBlock> u, v, half;  ///< centre and half of the width [px]
  std::array<float, kBlock> z;           ///< depth [m]
};

void Painter::paint(const std::vector<PointRun>& runs, const PointStyle& style) {
  forEachRow(kBands, [&](int index) {
    const Band band = bandOf(index);
    for (const auto& run : runs) {
      if (run.top >= band.end || run.bottom < band.first) continue;
      for (std::size_t first = 0; first < run.count; first += kBlock) {
        const std::size_t count = std::min(kBlock, run.count - first);
        paintBlock(run.points + first, count, style, band);
      }
    }
  });
  shown_ = false;
}

/// All points of a block, without branches: vectors.
void Painter::projectBlock(const PaintedPoint* points, std::size_t count, const PointStyle& style,
                           Projected& out) const {
  const Eigen::Matrix3f R = R_camera_map_;
  const Eigen::Vector3f t = t_camera_map_;
  const auto fx = static_cast<float>(view_.fx), fy = static_cast<float>(view_.fy);
  const auto cx = static_cast<float>(view_.cx), cy = static_cast<float>(view_.cy);
  const float half_m = 0.5F * kOverlap * style.width_m * fx;
  const float min_half = 0.5F * style.min_px, max_half = 0.5F * style.max_px;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = points[i].position.x(), y = points[i].position.y(), z = points[i].position.z();
    const float depth = R(2, 0) * x + R(2, 1) * y + R(2, 2) * z + t.z();
    const float inverse = 1.F / depth;
    out.u[i] = fx * (R(0, 0) * x + R(0, 1) * y + R(0, 2) * z + t.x()) * inverse + cx;
    out.v[i] = fy * (R(1, 0) * x + R(1, 1) * y + R(1, 2) * z + t.y()) * inverse + cy;
    out.half[i] = std::min(max_half, std::max(min_half, half_m * inverse));
    out.z[i] = depth;
  }
}

void Painter::paintBlock(const PaintedPoint* points, std::size_t count, const PointStyle& style,
                         const Band& band) {
  Projected projected;
  projectBlock(points, count, style, projected);
  const float near_m = std::max(style.near_m, static_cast<float>(view_.near_m));
  const auto far_m = static_cast<float>(view_.far_m);
  const auto width = static_cast<float>(view_.width);
  const auto first = static_cast<float>(band.first), end = static_cast<float>(band.end);
  for (std::size_t i = 0; i < count; ++i) {
    const float u = projected.u[i], v = projected.v[i], half = projected.half[i];
    if (!(projected.z[i] > near_m && projected.z[i] < far_m)) continue;
    if (!(u + half >= 0.F && v + half >= first && u - half < width && v - half < end)) continue;
    const float z = projected.z[i] - style.nearer_m;
    const bool hidden = style.width_m > 0.F && isHidden(u, v, z - style.width_m, band);
    if (!hidden) paintDisc(u, v, half, z, packed(points[i].colour), band);
  }
}

/// The pixels whose centre is in the disc, or in the square if it is small: at least one, exactly n
/// in a row of a square of n pixels.
void Painter::paintDisc(float u, float v, float half, float z, std::uint32_t colour,
                        const Band& band) {
  const int left = std::max(0, rowFrom(u - half));
  const int right = std::min(view_.width, rowFrom(u + half));
  const int top = std::max(band.first, rowFrom(v - half));
  const int bottom = std::min(band.end, rowFrom(v + half));
  const bool round = half > kMinRound;
  const float side = static_cast<float>(right - left);
  const float centre = round ? u : 0.5F * static_cast<float>(left + right - 1);
  for (int row = top; row < bottom; ++row) {
    const float up = static_cast<float>(row) - v;
    const float square_radius = round ? half * half - up * up : 0.25F * side * side;
    paintRow(z, colour, centre, square_radius, left, right, depths_.ptr<float>(row),
             points_.ptr<std::uint32_t>(row));
  }
}

/// Whether something is drawn before a place of the picture, in the row of the band that is nearest
/// to it; false to the left and right of the picture.
bool Painter::isHidden(float u, float v, float z, const Band& band) const {
  const int column = static_cast<int>(u);
  if (!(u >= 0.F) || column >= depths_.cols) return false;
  const int row = std::clamp(static_cast<int>(v), band.first, band.end - 1);
  return depths_.ptr<float>(row)[column] < z;
}

namespace {

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
    const int shown = static_cast<int>(opacity) >> (hidden ? 2 : 0);  // to a quarter
    auto& bgr = pixel[column];
    bgr = {blended(bgr[0], colour.blue, shown), blended(bgr[1], colour.green, shown),
           blended(bgr[2], colour.red, shown)};
    inverse += inverse_step;
    opacity += opacity_step;
  }
}

}  // namespace headway::render
