#include <headway/render/pinhole_view.h>

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

Pose lookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up) {
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d right = forward.cross(up).normalized();
  Pose T_map_camera = Pose::Identity();
  T_map_camera.linear().col(0) = right;
  T_map_camera.linear().col(1) = forward.cross(right);
  T_map_camera.linear().col(2) = forward;
  T_map_camera.translation() = eye;
  return T_map_camera;
}

std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_map, const PinholeView& view) {
  const Eigen::Vector3d point = view.T_map_camera.inverse() * point_map;
  if (!(point.z() >= view.near_m && point.z() <= view.far_m)) return std::nullopt;
  return Eigen::Vector2d(view.fx * point.x() / point.z() + view.cx,
                         view.fy * point.y() / point.z() + view.cy);
}

}  // namespace headway::render
