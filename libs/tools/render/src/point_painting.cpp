// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/parallel_rows.h>
#include <headway/render/painter.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace headway::render {
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

}  // namespace headway::render
