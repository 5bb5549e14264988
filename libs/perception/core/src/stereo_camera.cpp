// SPDX-License-Identifier: BSD-3-Clause
// The rectified stereo camera: calibration, projection, triangulation.
#include <headway/core/error.h>
#include <headway/core/stereo_camera.h>
#include <headway/core/text.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace headway {
namespace {

void requirePositive(double value, const char* name, const char* unit) {
  if (!(std::isfinite(value) && value > 0.0)) {
    throw InputError("stereo calibration: " + std::string(name) + " is " + std::to_string(value) +
                     " " + unit + ", must be positive and finite");
  }
}

}  // namespace

void validate(const StereoCamera& camera) {
  requirePositive(camera.width, "image width", "px");
  requirePositive(camera.height, "image height", "px");
  requirePositive(camera.fx, "focal length fx", "px");
  requirePositive(camera.fy, "focal length fy", "px");
  requirePositive(camera.baseline_m, "baseline", "m");
  const double max_offset = 10.0 * std::max(camera.width, camera.height);  // beyond any real lens
  if (!(std::abs(camera.cx) <= max_offset && std::abs(camera.cy) <= max_offset)) {
    throw InputError("stereo calibration: the principal point (" + std::to_string(camera.cx) +
                     ", " + std::to_string(camera.cy) + ") px is far outside the image");
  }
  if (!camera.T_robot_cam.matrix().allFinite()) {
    throw InputError("stereo calibration: the camera's pose on the robot is not finite");
  }
  const double distance_m = camera.T_robot_cam.translation().norm();
  if (distance_m > kMaxMountingDistance_m) {  // a pose in centimetres or millimetres
    throw InputError("stereo calibration: the camera is " + std::to_string(distance_m) +
                     " m from the robot's origin; check the unit (metres) of its pose");
  }
}

std::optional<Eigen::Vector3d> project(const Eigen::Vector3d& point, const StereoCamera& camera) {
  if (!(point.z() > 0.0)) return std::nullopt;
  const double inverse_depth = 1.0 / point.z();
  return Eigen::Vector3d(camera.fx * point.x() * inverse_depth + camera.cx,
                         camera.fy * point.y() * inverse_depth + camera.cy,
                         camera.fx * camera.baseline_m * inverse_depth);
}

std::optional<Eigen::Vector3d> triangulate(const Eigen::Vector3d& uvd, const StereoCamera& camera) {
  if (!(uvd.z() > 0.0)) return std::nullopt;
  const double depth = camera.fx * camera.baseline_m / uvd.z();
  return Eigen::Vector3d(depth * ray(uvd.head<2>(), camera));
}

Eigen::Vector3d ray(const Eigen::Vector2d& uv, const StereoCamera& camera) {
  return {(uv.x() - camera.cx) / camera.fx, (uv.y() - camera.cy) / camera.fy, 1.0};
}

namespace {

std::string textOf(const StereoCamera& camera) {
  return formatted("%dx%d px, f %.2f %.2f px, centre %.2f %.2f px, baseline %.4f m", camera.width,
                   camera.height, camera.fx, camera.fy, camera.cx, camera.cy, camera.baseline_m);
}

}  // namespace

std::optional<std::string> differenceBetween(const StereoCamera& other, const StereoCamera& here) {
  // One part in a thousand: files round, calibrations of another camera differ by more.
  const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-3 * std::abs(b); };
  const bool same = other.width == here.width && other.height == here.height &&
                    near(other.fx, here.fx) && near(other.fy, here.fy) && near(other.cx, here.cx) &&
                    near(other.cy, here.cy) && near(other.baseline_m, here.baseline_m);
  if (same) return std::nullopt;
  return textOf(other) + "; here " + textOf(here);
}

}  // namespace headway
