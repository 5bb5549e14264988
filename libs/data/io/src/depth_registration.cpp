// SPDX-License-Identifier: BSD-3-Clause
#include "depth_registration.h"

#include <headway/core/error.h>
#include <headway/io/camera_info.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "rectifier.h"

namespace headway::io {
namespace {

constexpr double kDepthNoise = 0.0025;       // error of a depth by its square [1/m]
constexpr double kSigmaDisparityPx = 0.4;    // as assumed of stereo cameras
constexpr std::uint16_t kSaturated = 65535;  // written by some drivers where nothing was measured
constexpr double kSamePose = 1e-5;           // [rad], [m]
constexpr float kNearestM = 0.05F;           // nearer is none
// Between depth and intensity camera: beyond it, ground beside an obstacle that the depth camera
// does not measure would appear in the obstacle's place.
constexpr double kMaxOffsetM = 0.15;
constexpr double kMinUnitM = 1e-6, kMaxUnitM = 0.1;
// Between the pixels of one surface:
constexpr float kStep = 3.0F;              // [px]
constexpr float kStepRatio = 0.06F;        // or this ratio of the disparity
constexpr float kMaxTriangleSide = 64.0F;  // of a triangle between neighbouring pixels [px]
constexpr float kRounding = 1e-3F;         // of a pixel on an edge, relative to a triangle

bool isSameLens(const RawCamera& lens, const StereoCamera& camera) {
  const auto is_set = [](double k) { return k != 0.0; };
  return lens.width == camera.width && lens.height == camera.height && lens.fx == camera.fx &&
         lens.fy == camera.fy && lens.cx == camera.cx && lens.cy == camera.cy && !lens.is_fisheye &&
         std::none_of(lens.distortion.begin(), lens.distortion.end(), is_set) &&
         std::none_of(lens.rational.begin(), lens.rational.end(), is_set);
}

/// A depth pixel in the intensity image.
using Point = cv::Vec3f;  // u, v, disparity [px]; disparity 0: nothing was measured

/// Whether three pixels are of one surface.
bool isSurface(const Point& a, const Point& b, const Point& c) {
  const auto [least, most] = std::minmax({a[2], b[2], c[2]});
  return least > 0.0F && most - least <= std::max(kStep, kStepRatio * most);
}

/// Fills a triangle; disparities are linear in the image on a plane. The nearest surface counts.
void fill(const Point& a, const Point& b, const Point& c, cv::Mat& disparities) {
  if (!isSurface(a, b, c)) return;
  const auto [left, right] = std::minmax({a[0], b[0], c[0]});
  const auto [top, bottom] = std::minmax({a[1], b[1], c[1]});
  // Pixels at the edge of a lens may be anywhere.
  const bool is_inside = right >= 0.0F && bottom >= 0.0F &&
                         left <= static_cast<float>(disparities.cols) &&
                         top <= static_cast<float>(disparities.rows);
  if (!is_inside || right - left > kMaxTriangleSide || bottom - top > kMaxTriangleSide) return;
  const float area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
  if (!(area > 0.0F)) return;  // seen from behind
  const int last_u =
      std::min(disparities.cols - 1, static_cast<int>(std::floor(right + kRounding)));
  const int last_v =
      std::min(disparities.rows - 1, static_cast<int>(std::floor(bottom + kRounding)));
  const int first_u = std::max(0, static_cast<int>(std::ceil(left - kRounding)));
  for (int v = std::max(0, static_cast<int>(std::ceil(top - kRounding))); v <= last_v; ++v) {
    auto* row = disparities.ptr<float>(v);
    for (int u = first_u; u <= last_u; ++u) {
      const float du = static_cast<float>(u) - a[0];
      const float dv = static_cast<float>(v) - a[1];
      const float of_b = (du * (c[1] - a[1]) - (c[0] - a[0]) * dv) / area;
      const float of_c = ((b[0] - a[0]) * dv - du * (b[1] - a[1])) / area;
      if (of_b < -kRounding || of_c < -kRounding || of_b + of_c > 1.0F + kRounding) continue;
      row[u] = std::max(row[u], a[2] + of_b * (b[2] - a[2]) + of_c * (c[2] - a[2]));
    }
  }
}

}  // namespace

void validate(const RawDepthCamera& camera) {
  const auto refuse = [](const std::string& reason) {
    throw InputError("calibration of the depth camera: " + reason);
  };
  if (const auto fault = lensFault(camera.color); !fault.empty()) {
    refuse("the intensity image (cameraParamsIntensity): " + fault);
  }
  if (const auto fault = lensFault(camera.depth); !fault.empty()) {
    refuse("the depth image (cameraParams): " + fault);
  }
  const double offset = camera.T_color_depth.translation().norm();
  if (!camera.T_color_depth.matrix().allFinite() || offset > kMaxOffsetM) {
    refuse("both cameras are " + std::to_string(offset) +
           " m apart (relativePoseIntensityWRTDepth): in metres?");
  }
  if (camera.T_color_depth.linear()(2, 2) < 0.5) {
    refuse(
        "both cameras look in different directions: relativePoseIntensityWRTDepth is that of "
        "optical axes (x right, y down, z forward) in a sensor with x forward");
  }
  if (!(camera.metres_per_unit >= kMinUnitM && camera.metres_per_unit <= kMaxUnitM)) {
    refuse("a unit of the depth image is " + std::to_string(camera.metres_per_unit) +
           " m (rangeUnits); it is 0.001 as a rule");
  }
}

double equivalentBaseline(double focal_px) { return kSigmaDisparityPx / (kDepthNoise * focal_px); }

DepthRegistration::DepthRegistration(const RawDepthCamera& recorded, const StereoCamera& target)
    : recorded_(recorded), target_(target) {
  is_registered_ =
      isSameLens(recorded.depth, target) && recorded.T_color_depth.matrix().isIdentity(kSamePose);
  std::vector<cv::Point2d> pixels;
  pixels.reserve(static_cast<std::size_t>(size().area()));
  for (int v = 0; v < size().height; ++v) {
    for (int u = 0; u < size().width; ++u) pixels.emplace_back(u, v);
  }
  const auto rays = raysOf(pixels, recorded.depth);
  cv::Mat(rays, true).reshape(2, size().height).convertTo(rays_, CV_32F);
}

cv::Mat DepthRegistration::disparities(const cv::Mat& ranges) const {
  const cv::Mat points = projected(ranges);
  cv::Mat result(target_.height, target_.width, CV_32F, cv::Scalar(0));
  if (is_registered_) {
    cv::extractChannel(points, result, 2);
    return result;
  }
  for (int v = 0; v + 1 < points.rows; ++v) {
    const auto* upper = points.ptr<Point>(v);
    const auto* lower = points.ptr<Point>(v + 1);
    for (int u = 0; u + 1 < points.cols; ++u) {
      fill(upper[u], upper[u + 1], lower[u], result);
      fill(upper[u + 1], lower[u + 1], lower[u], result);
    }
  }
  return result;
}

/// The depth pixels in the rectified intensity image.
cv::Mat DepthRegistration::projected(const cv::Mat& ranges) const {
  cv::Mat points(ranges.size(), CV_32FC3, cv::Scalar::all(0));
  const Eigen::Matrix3f R = recorded_.T_color_depth.linear().cast<float>();
  const Eigen::Vector3f t = recorded_.T_color_depth.translation().cast<float>();
  const auto unit = static_cast<float>(recorded_.metres_per_unit);
  const auto fx = static_cast<float>(target_.fx), fy = static_cast<float>(target_.fy);
  const auto cx = static_cast<float>(target_.cx), cy = static_cast<float>(target_.cy);
  const auto focal_baseline = static_cast<float>(target_.fx * target_.baseline_m);
  for (int v = 0; v < ranges.rows; ++v) {
    const auto* range = ranges.ptr<std::uint16_t>(v);
    const auto* ray = rays_.ptr<cv::Vec2f>(v);
    auto* point = points.ptr<Point>(v);
    for (int u = 0; u < ranges.cols; ++u) {
      if (range[u] == 0 || range[u] == kSaturated) continue;
      const Eigen::Vector3f direction(ray[u][0], ray[u][1], 1.0F);
      float depth = unit * static_cast<float>(range[u]);
      if (!recorded_.ranges_are_depths) depth /= direction.norm();
      const Eigen::Vector3f seen = R * (depth * direction) + t;
      if (!(seen.z() > kNearestM)) continue;
      point[u] = {fx * seen.x() / seen.z() + cx, fy * seen.y() / seen.z() + cy,
                  focal_baseline / seen.z()};
    }
  }
  return points;
}

}  // namespace headway::io
