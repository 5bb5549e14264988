// SPDX-License-Identifier: BSD-3-Clause
// The view of a virtual pinhole camera.
#pragma once

#include <headway/core/pose.h>

#include <Eigen/Core>
#include <optional>
#include <utility>

namespace headway::render {

/// Camera of a rendered picture: ideal pinhole (x right, y down, z forward).
///
/// Pixels have integer centres, as in StereoCamera.
struct PinholeView {
  int width = 0;                                  ///< [px]
  int height = 0;                                 ///< [px]
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< [px]
  Pose T_map_camera = Pose::Identity();
  double near_m = 0.3;   ///< near clipping distance [m]
  double far_m = 300.0;  ///< far clipping distance [m]
};

/// A view of the given size [px] and horizontal field of view [rad] with a central principal point.
[[nodiscard]] PinholeView makeView(int width, int height, double horizontal_fov,
                                   const Pose& T_map_camera);

/// Pose of a camera at `viewpoint` directed at `target`, with `up` upwards in its picture.
///
/// @param up  not parallel to the viewing direction
[[nodiscard]] Pose lookAt(const Eigen::Vector3d& viewpoint, const Eigen::Vector3d& target,
                          const Eigen::Vector3d& up = Eigen::Vector3d::UnitZ());

/// Projects a point of the map [px].
///
/// @return possibly outside the picture; nullopt if the depth is not between near_m and far_m
[[nodiscard]] std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_map,
                                                     const PinholeView& view);

/// Projects a line segment of the map [px], clipped to depths between near_m and far_m.
///
/// @return nullopt if no part of the segment is in this range
[[nodiscard]] std::optional<std::pair<Eigen::Vector2d, Eigen::Vector2d>> projectSegment(
    const Eigen::Vector3d& from_map, const Eigen::Vector3d& to_map, const PinholeView& view);

}  // namespace headway::render
