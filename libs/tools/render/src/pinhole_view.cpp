// SPDX-License-Identifier: BSD-3-Clause
// The view of a virtual pinhole camera.
#include <headway/render/pinhole_view.h>

#include <algorithm>
#include <cmath>

namespace headway::render {

PinholeView makeView(int width, int height, double horizontal_fov, const Pose& T_map_camera) {
  PinholeView view;
  view.width = width;
  view.height = height;
  view.fx = view.fy = 0.5 * width / std::tan(0.5 * horizontal_fov);
  view.cx = 0.5 * (width - 1);
  view.cy = 0.5 * (height - 1);
  view.T_map_camera = T_map_camera;
  return view;
}

Pose lookAt(const Eigen::Vector3d& viewpoint, const Eigen::Vector3d& target,
            const Eigen::Vector3d& up) {
  const Eigen::Vector3d forward = (target - viewpoint).normalized();
  const Eigen::Vector3d right = forward.cross(up).normalized();
  Pose T_map_camera = Pose::Identity();
  T_map_camera.linear().col(0) = right;
  T_map_camera.linear().col(1) = forward.cross(right);
  T_map_camera.linear().col(2) = forward;
  T_map_camera.translation() = viewpoint;
  return T_map_camera;
}

namespace {

Eigen::Vector2d pixelOf(const Eigen::Vector3d& point, const PinholeView& view) {
  return {view.fx * point.x() / point.z() + view.cx, view.fy * point.y() / point.z() + view.cy};
}

}  // namespace

std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_map, const PinholeView& view) {
  const Eigen::Vector3d point = view.T_map_camera.inverse() * point_map;
  if (!(point.z() >= view.near_m && point.z() <= view.far_m)) return std::nullopt;
  return pixelOf(point, view);
}

std::optional<std::pair<Eigen::Vector2d, Eigen::Vector2d>> projectSegment(
    const Eigen::Vector3d& from_map, const Eigen::Vector3d& to_map, const PinholeView& view) {
  const Eigen::Vector3d from = view.T_map_camera.inverse() * from_map;
  const Eigen::Vector3d to = view.T_map_camera.inverse() * to_map;
  const double depth = to.z() - from.z();
  double first = 0.0;
  double last = 1.0;
  if (std::abs(depth) > 1e-12) {
    const double at_near = (view.near_m - from.z()) / depth;
    const double at_far = (view.far_m - from.z()) / depth;
    first = std::max(first, std::min(at_near, at_far));
    last = std::min(last, std::max(at_near, at_far));
  } else if (!(from.z() >= view.near_m && from.z() <= view.far_m)) {
    return std::nullopt;
  }
  if (!(first < last)) return std::nullopt;
  const auto at = [&](double ratio) { return Eigen::Vector3d(from + ratio * (to - from)); };
  return std::make_pair(pixelOf(at(first), view), pixelOf(at(last), view));
}

}  // namespace headway::render
