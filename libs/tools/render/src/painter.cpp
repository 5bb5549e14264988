// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/parallel_rows.h>
#include <headway/render/painter.h>

#include <algorithm>
#include <cmath>

namespace headway::render {
namespace {

constexpr float kNoDepth = 1e9F;         // [m]
constexpr float kShade = 1.2F;           // darkening by the ratio of the distance behind an edge
constexpr float kMinLight = 0.4F;        // behind an edge
constexpr float kFullLight = 0.96F;      // from which a surface is not an edge
constexpr double kSkyGradientSin = 0.5;  // sine of the elevation with the zenith's colour
constexpr double kGroundGradientSin = 0.12;  // sine of the depression with the ground's colour

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
  if (light > kFullLight) return colour;
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
                            ? mixed(backdrop.horizon, backdrop.ground, -up / kGroundGradientSin)
                            : mixed(backdrop.horizon, backdrop.zenith, up / kSkyGradientSin);
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

}  // namespace headway::render
