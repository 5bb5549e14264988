#include <headway/core/detection.h>

#include <cmath>

namespace headway {

Box3d opticalBox(const Eigen::Vector3d& centre, const Eigen::Vector3d& size, double yaw,
                 const Pose& T_optical_frame) {
  const Eigen::Vector3d front(std::cos(yaw), std::sin(yaw), 0.0);
  return {T_optical_frame * centre, size.x(), size.y(), size.z(),
          opticalYaw(T_optical_frame.linear() * front)};
}

bool isFinite(const Box2d& box) {
  return std::isfinite(box.left) && std::isfinite(box.top) && std::isfinite(box.right) &&
         std::isfinite(box.bottom);
}

bool isFinite(const Box3d& box) {
  return box.centre.allFinite() && std::isfinite(box.length) && std::isfinite(box.width) &&
         std::isfinite(box.height) && std::isfinite(box.yaw);
}

Eigen::Vector3d frontOf(const Box3d& box) { return {std::cos(box.yaw), 0.0, -std::sin(box.yaw)}; }

double opticalYaw(const Eigen::Vector3d& direction) {
  return wrapAngle(std::atan2(-direction.z(), direction.x()));
}

}  // namespace headway
