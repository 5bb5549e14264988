// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/parallel_rows.h>
#include <headway/render/painter.h>

#include <algorithm>
#include <cmath>

namespace headway::render {
namespace {

constexpr float kNoDepth = 1e9F;         // [m]
constexpr float kOverlap = 1.5F;         // of neighbouring discs, which are seen at an angle
constexpr float kMinRound = 2.5F;        // radius from which points are discs [px]
constexpr float kShade = 1.2F;           // darkening by the ratio of the distance behind an edge
constexpr float kMinLight = 0.4F;        // behind an edge
constexpr float kFullLight = 0.96F;      // from which a surface is not an edge
constexpr double kSkyGradientSin = 0.5;  // sine of the elevation with the zenith's colour
constexpr double kGroundGradientSin = 0.12;  // sine of the depression with the ground's colour

std::uint32_t packed(const Colour& colour) {
  return static_cast<std::uint32_t>(colour.red << 16 | colour.green << 8 | colour.blue);
}

cv::Vec3b bgrOf(std::uint32_t colour) {
  return {static_cast<std::uint8_t>(colour), static_cast<std::uint8_t>(colour >> 8),
          static_cast<std::uint8_t>(colour >> 16)};
}

/// The first row or column whose centre is not before a place in the picture or near it.
int rowFrom(float place) {
  const int towards_zero = static_cast<int>(place);
  return towards_zero + (static_cast<float>(towards_zero) < place ? 1 : 0);
}

/// Paints the pixels of a row where nothing nearer is painted; without branches, for vectors.
void paintRow(float z, std::uint32_t colour, int first, int end, float* depths,
              std::uint32_t* colours) {
  for (int column = first; column < end; ++column) {
    const bool is_nearer = z < depths[column];
    depths[column] = is_nearer ? z : depths[column];
    colours[column] = is_nearer ? colour : colours[column];
  }
}

cv::Vec3b mixed(const Colour& from, const Colour& to, double ratio) {
  const double part = std::clamp(ratio, 0.0, 1.0);
  const auto mix = [&](std::uint8_t a, std::uint8_t b) {
    return cv::saturate_cast<std::uint8_t>(a + part * (b - a));
  };
  return {mix(from.blue, to.blue), mix(from.green, to.green), mix(from.red, to.red)};
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
    const float shaded = std::max(kMinLight, 1.F - kShade * nearer / z);
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
      points_(height, width, CV_32S),
      depths_(height, width, CV_32F) {}

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
    depths_.row(row).setTo(kNoDepth);
    const Eigen::Vector3d ray =
        view.T_map_camera.linear() * Eigen::Vector3d(0.0, (row - view.cy) / view.fy, 1.0);
    const double up = ray.z() / ray.norm();
    colours_.row(row).setTo(up < 0.0
                                ? mixed(backdrop.horizon, backdrop.ground, -up / kGroundGradientSin)
                                : mixed(backdrop.horizon, backdrop.zenith, up / kSkyGradientSin));
  });
}

void Painter::paint(const std::vector<PointRun>& runs, const PointStyle& style) {
  forEachRow(kBands, [&](int index) {
    const Band band = bandOf(index);
    for (const auto& run : runs) {
      if (run.top < band.end && run.bottom >= band.first) paintPoints(run, style, band);
    }
    showPoints(band);
  });
}

void Painter::paintPoints(const PointRun& run, const PointStyle& style, const Band& band) {
  const auto fx = static_cast<float>(view_.fx), fy = static_cast<float>(view_.fy);
  const auto cx = static_cast<float>(view_.cx), cy = static_cast<float>(view_.cy);
  const float near_m = std::max(style.near_m, static_cast<float>(view_.near_m));
  const auto far_m = static_cast<float>(view_.far_m);
  const auto width = static_cast<float>(view_.width);
  const auto first = static_cast<float>(band.first), end = static_cast<float>(band.end);
  for (const PaintedPoint* point = run.points; point != run.points + run.count; ++point) {
    const Eigen::Vector3f p = R_camera_map_ * point->position + t_camera_map_;
    if (!(p.z() > near_m && p.z() < far_m)) continue;
    const float inverse = 1.F / p.z();
    const float u = fx * p.x() * inverse + cx;
    const float v = fy * p.y() * inverse + cy;
    const float half =
        0.5F * std::clamp(kOverlap * style.width_m * fx * inverse, style.min_px, style.max_px);
    if (!(u + half >= 0.F && v + half >= first && u - half < width && v - half < end)) continue;
    const float z = p.z() - style.nearer_m;
    const bool hidden = style.width_m > 0.F && isHidden(u, v, z - style.width_m, band);
    if (!hidden) paintDisc(u, v, half, z, packed(point->colour), band);
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
  for (int row = top; row < bottom; ++row) {
    int first = left, end = right;
    if (round) {
      const float up = static_cast<float>(row) - v;
      const float across = std::sqrt(std::max(0.F, half * half - up * up));
      first = std::max(left, rowFrom(u - across));
      end = std::min(right, rowFrom(u + across));
    }
    paintRow(z, colour, first, end, depths_.ptr<float>(row), points_.ptr<std::uint32_t>(row));
  }
}

/// Copies the colours of the points to the picture.
void Painter::showPoints(const Band& band) {
  for (int row = band.first; row < band.end; ++row) {
    const auto* depth = depths_.ptr<float>(row);
    const auto* point = points_.ptr<std::uint32_t>(row);
    auto* pixel = colours_.ptr<cv::Vec3b>(row);
    for (int column = 0; column < colours_.cols; ++column) {
      if (depth[column] < kNoDepth) pixel[column] = bgrOf(point[column]);
    }
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

void Painter::shade() {
  const int reach = std::max(1, view_.height / 500);
  forEachRow(colours_.rows, [&](int row) {
    std::vector<float> light(static_cast<std::size_t>(colours_.cols), 1.F);
    lightOfRow(depths_, row, reach, light.data());
    auto* pixel = colours_.ptr<cv::Vec3b>(row);
    for (const float factor : light) {
      auto& bgr = *pixel++;
      if (factor > kFullLight) continue;
      for (int channel = 0; channel < 3; ++channel) {
        bgr[channel] = static_cast<std::uint8_t>(factor * static_cast<float>(bgr[channel]));
      }
    }
  });
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

}  // namespace headway::render
