// SPDX-License-Identifier: BSD-3-Clause
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

cv::Vec3b bgrOf(const Colour& colour) { return {colour.blue, colour.green, colour.red}; }

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
    : colours_(height, width, CV_8UC3), depths_(height, width, CV_32F) {}

void Painter::clear(const PinholeView& view, const Backdrop& backdrop) {
  CV_Assert(view.width == colours_.cols && view.height == colours_.rows);
  view_ = view;
  depths_.setTo(kNoDepth);
  for (int row = 0; row < colours_.rows; ++row) {
    const Eigen::Vector3d ray =
        view.T_map_camera.linear() * Eigen::Vector3d(0.0, (row - view.cy) / view.fy, 1.0);
    const double up = ray.z() / ray.norm();
    colours_.row(row).setTo(up < 0.0
                                ? mixed(backdrop.horizon, backdrop.ground, -up / kGroundGradientSin)
                                : mixed(backdrop.horizon, backdrop.zenith, up / kSkyGradientSin));
  }
}

void Painter::paint(const PaintedPoint* points, std::size_t count, const PointStyle& style) {
  const Pose T_camera_map = view_.T_map_camera.inverse();
  const Eigen::Matrix3f R = T_camera_map.linear().cast<float>();
  const Eigen::Vector3f t = T_camera_map.translation().cast<float>();
  const auto fx = static_cast<float>(view_.fx), fy = static_cast<float>(view_.fy);
  const auto cx = static_cast<float>(view_.cx), cy = static_cast<float>(view_.cy);
  const float near_m = std::max(style.near_m, static_cast<float>(view_.near_m));
  const auto far_m = static_cast<float>(view_.far_m);
  const auto width = static_cast<float>(view_.width), height = static_cast<float>(view_.height);
  for (const PaintedPoint* point = points; point != points + count; ++point) {
    const Eigen::Vector3f p = R * point->position + t;
    if (!(p.z() > near_m && p.z() < far_m)) continue;
    const float inverse = 1.F / p.z();
    const float u = fx * p.x() * inverse + cx;
    const float v = fy * p.y() * inverse + cy;
    const float half =
        0.5F * std::clamp(kOverlap * style.width_m * fx * inverse, style.min_px, style.max_px);
    if (!(u + half >= 0.F && v + half >= 0.F && u - half < width && v - half < height)) continue;
    const float z = p.z() - style.nearer_m;
    const bool hidden = style.width_m > 0.F && isHidden(u, v, z - style.width_m);
    if (!hidden) paintDisc(u, v, half, z, bgrOf(point->colour));
  }
}

/// The pixels whose centre is in the disc, or in the square if it is small: at least one, exactly n
/// in a row of a square of n pixels.
void Painter::paintDisc(float u, float v, float half, float z, const cv::Vec3b& colour) {
  const auto firstFrom = [](float from) { return std::max(0, static_cast<int>(std::ceil(from))); };
  const int left = firstFrom(u - half), top = firstFrom(v - half);
  const int right = std::min(view_.width, static_cast<int>(std::ceil(u + half)));
  const int bottom = std::min(view_.height, static_cast<int>(std::ceil(v + half)));
  const bool round = half > kMinRound;
  for (int row = top; row < bottom; ++row) {
    auto* depth = depths_.ptr<float>(row);
    auto* pixel = colours_.ptr<cv::Vec3b>(row);
    int first = left, end = right;
    if (round) {
      const float up = static_cast<float>(row) - v;
      const float across = std::sqrt(std::max(0.F, half * half - up * up));
      first = std::max(left, static_cast<int>(std::ceil(u - across)));
      end = std::min(right, static_cast<int>(std::ceil(u + across)));
    }
    for (int column = first; column < end; ++column) {
      if (z >= depth[column]) continue;
      depth[column] = z;
      pixel[column] = colour;
    }
  }
}

/// Whether something is drawn before a place of the picture; false outside of it.
bool Painter::isHidden(float u, float v, float z) const {
  if (!(u >= 0.F && v >= 0.F)) return false;
  const int column = static_cast<int>(u), row = static_cast<int>(v);
  if (column >= depths_.cols || row >= depths_.rows) return false;
  return depths_.ptr<float>(row)[column] < z;
}

void Painter::shade() {
  const int reach = std::max(1, view_.height / 500);
  std::vector<float> light(static_cast<std::size_t>(colours_.cols), 1.F);
  for (int row = 0; row < colours_.rows; ++row) {
    lightOfRow(depths_, row, reach, light.data());
    auto* pixel = colours_.ptr<cv::Vec3b>(row);
    for (const float factor : light) {
      auto& bgr = *pixel++;
      if (factor > kFullLight) continue;
      for (int channel = 0; channel < 3; ++channel) {
        bgr[channel] = static_cast<std::uint8_t>(factor * static_cast<float>(bgr[channel]));
      }
    }
  }
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
