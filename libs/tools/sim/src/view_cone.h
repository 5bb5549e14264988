// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <Eigen/Core>
#include <cmath>

namespace headway::sim {

/// What a camera can see of the ground plan: all within an angle of its viewing direction.
struct ViewCone {
  Eigen::Vector2d viewpoint = Eigen::Vector2d::Zero();  ///< world [m]
  double heading = 0.0;                                 ///< about world z [rad]
  double half_width = M_PI;                             ///< half the horizontal field of view [rad]

  /// Whether any of a disc is seen.
  [[nodiscard]] bool touches(const Eigen::Vector2d& middle, double radius) const {
    const Eigen::Vector2d offset = middle - viewpoint;
    const double distance = offset.norm();
    if (distance <= radius) return true;
    const double off_axis =
        std::abs(std::remainder(std::atan2(offset.y(), offset.x()) - heading, 2.0 * M_PI));
    return off_axis < half_width + std::asin(radius / distance);
  }
};

/// What a camera on the robot sees, and a little more.
[[nodiscard]] inline ViewCone viewCone(const StereoCamera& camera, const Pose& T_world_robot) {
  const Eigen::Vector3d viewpoint = (T_world_robot * camera.T_robot_cam).translation();
  return {viewpoint.head<2>(), yawOf(T_world_robot),
          std::atan(0.5 * camera.width / camera.fx) + 0.02};
}

}  // namespace headway::sim
