// SPDX-License-Identifier: BSD-3-Clause
// The true camera and the recorded one: distortion and errors of the calibration.
#include "lens.h"

#include <headway/core/error.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace headway::sim {
namespace {

StereoCamera idealCamera(const CameraParams& params) {
  StereoCamera camera;
  camera.width = params.width;
  camera.height = params.height;
  camera.fx = camera.fy = params.focal_px;
  camera.cx = 0.5 * (params.width - 1);
  camera.cy = 0.5 * (params.height - 1);
  camera.baseline_m = params.baseline_m;
  if (params.depth_camera) camera.depth_reach_m = params.depth_max_m;
  const Eigen::AngleAxisd down(params.pitch_down_deg * M_PI / 180.0, Eigen::Vector3d::UnitY());
  camera.T_robot_cam = down * robotFromOptical();
  camera.T_robot_cam.translation() =
      Eigen::Vector3d(params.mount_forward_m, 0.5 * params.baseline_m, params.mount_height_m);
  return camera;
}

StereoCamera trueCamera(StereoCamera camera, const CalibrationErrorParams& error) {
  camera.fx *= 1.0 + error.focal_ratio;
  camera.fy *= 1.0 + error.focal_ratio;
  camera.baseline_m *= 1.0 + error.baseline_ratio;
  return camera;
}

/// The right camera's optical frame in the left one: x right, y down, z forward.
Pose trueRightCamera(const StereoCamera& camera, const CalibrationErrorParams& error) {
  Pose T_left_right = Pose::Identity();
  T_left_right.translation().x() = camera.baseline_m;
  T_left_right.linear() =
      expSo3(Eigen::Vector3d(error.right_pitch_deg, error.right_yaw_deg, error.right_roll_deg) *
             M_PI / 180.0);
  return T_left_right;
}

/// Radius without distortion of a distorted one (both at unit depth): Newton's method on
/// r (1 + k1 r^2 + k2 r^4) = distorted.
std::optional<double> undistortedRadius(double distorted, double k1, double k2) {
  double r = distorted;
  for (int i = 0; i < 50; ++i) {
    const double r2 = r * r;
    const double slope = 1.0 + 3.0 * k1 * r2 + 5.0 * k2 * r2 * r2;
    if (slope < 0.05) return std::nullopt;  // the image folds over itself
    const double step = (r * (1.0 + k1 * r2 + k2 * r2 * r2) - distorted) / slope;
    r -= step;
    if (std::abs(step) < 1e-12) return r;
  }
  return std::nullopt;
}

}  // namespace

Lens::Lens(const CameraParams& params, const CalibrationErrorParams& error)
    : k1_(params.k1),
      k2_(params.k2),
      ideal_(idealCamera(params)),
      true_(trueCamera(ideal_, error)),
      drawn_(true_),
      T_left_right_(trueRightCamera(true_, error)) {
  if (k1_ == 0.0 && k2_ == 0.0) return;
  cv::Mat_<cv::Vec2f> rays(params.height, params.width);
  double reach_x = 0.0, reach_y = 0.0;
  for (int v = 0; v < params.height; ++v) {
    for (int u = 0; u < params.width; ++u) {
      const Eigen::Vector2d seen((u - true_.cx) / true_.fx, (v - true_.cy) / true_.fy);
      const auto radius = undistortedRadius(seen.norm(), k1_, k2_);
      if (!radius || *radius > 2.5) {
        throw InputError("[camera] k1, k2: so strong that the image's corners have no ray");
      }
      const double grow = seen.norm() > 1e-9 ? *radius / seen.norm() : 1.0;
      rays(v, u) = {static_cast<float>(seen.x() * grow), static_cast<float>(seen.y() * grow)};
      reach_x = std::max(reach_x, std::abs(seen.x()) * grow);
      reach_y = std::max(reach_y, std::abs(seen.y()) * grow);
    }
  }
  drawn_.width = 2 * static_cast<int>(std::ceil(reach_x * true_.fx)) + 4;
  drawn_.height = 2 * static_cast<int>(std::ceil(reach_y * true_.fy)) + 4;
  drawn_.cx = 0.5 * (drawn_.width - 1);
  drawn_.cy = 0.5 * (drawn_.height - 1);
  for (auto& ray : rays) {
    ray = {static_cast<float>(drawn_.cx + drawn_.fx * ray[0]),
           static_cast<float>(drawn_.cy + drawn_.fy * ray[1])};
  }
  map_ = rays;
}

io::RawStereoCamera Lens::recorded() const {
  io::RawStereoCamera camera = io::rawFrom(ideal_);
  camera.left.distortion = {k1_, k2_, 0.0, 0.0, 0.0};
  camera.right.distortion = camera.left.distortion;
  return camera;
}

cv::Mat Lens::record(const cv::Mat& drawing, bool smooth) const {
  if (!distorts()) return drawing;
  cv::Mat recorded;
  cv::remap(drawing, recorded, map_, cv::noArray(), smooth ? cv::INTER_LINEAR : cv::INTER_NEAREST);
  return recorded;
}

Eigen::Vector2d Lens::distort(const Eigen::Vector2d& drawn_px) const {
  const Eigen::Vector2d ray((drawn_px.x() - drawn_.cx) / drawn_.fx,
                            (drawn_px.y() - drawn_.cy) / drawn_.fy);
  const double r2 = ray.squaredNorm();
  const double scale = 1.0 + k1_ * r2 + k2_ * r2 * r2;
  return {true_.cx + true_.fx * ray.x() * scale, true_.cy + true_.fy * ray.y() * scale};
}

Box2d Lens::record(const Box2d& box) const {
  if (!distorts()) return box;
  constexpr int kSteps = 8;  // points along each edge: distorted edges are bent
  Box2d result{1e9, 1e9, -1e9, -1e9};
  for (int i = 0; i <= kSteps; ++i) {
    const double t = static_cast<double>(i) / kSteps;
    const double u = box.left + t * box.width(), v = box.top + t * box.height();
    for (const Eigen::Vector2d& edge :
         {Eigen::Vector2d(u, box.top), Eigen::Vector2d(u, box.bottom), Eigen::Vector2d(box.left, v),
          Eigen::Vector2d(box.right, v)}) {
      const Eigen::Vector2d at = distort(edge);
      result.left = std::min(result.left, at.x());
      result.right = std::max(result.right, at.x());
      result.top = std::min(result.top, at.y());
      result.bottom = std::max(result.bottom, at.y());
    }
  }
  return result;
}

}  // namespace headway::sim
