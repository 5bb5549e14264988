#include <headway/core/detection.h>

#include <cmath>

namespace headway {

Eigen::Vector3d frontOf(const Box3d& box) { return {std::cos(box.yaw), 0.0, -std::sin(box.yaw)}; }

double opticalYaw(const Eigen::Vector3d& direction) {
  return wrapAngle(std::atan2(-direction.z(), direction.x()));
}

}  // namespace headway
