#pragma once

#include <headway/core/pose.h>

#include <Eigen/Core>
#include <optional>
#include <utility>

namespace headway::render {

/// From where a picture is drawn: an ideal camera (x right, y down, z forward).
///
/// Pixels have integer centres, as in StereoCamera.
struct PinholeView {
  int width = 0;                                  ///< [px]
  int height = 0;                                 ///< [px]
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< [px]
  Pose T_map_camera = Pose::Identity();
  double near_m = 0.3;   ///< what is nearer is not drawn [m]
  double far_m = 300.0;  ///< what is farther is not drawn [m]
};

/// A view of given size and horizontal field of view [rad], principal point in the middle.
[[nodiscard]] PinholeView makeView(int width, int height, double horizontal_fov,
                                   const Pose& T_map_camera);

/// Pose of a camera at `eye` that looks at `target`, with `up` upwards in its picture.
///
/// @param up  any direction that is not the viewing direction
[[nodiscard]] Pose lookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                          const Eigen::Vector3d& up = Eigen::Vector3d::UnitZ());

/// Where a point of the map appears [px].
///
/// @return nullopt if it is nearer than near_m or farther than far_m (or behind); it may lie
///         outside the picture
[[nodiscard]] std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_map,
                                                     const PinholeView& view);

/// Where a straight line between two points of the map appears [px], as far as it lies between
/// near_m and far_m; nullopt if none of it does.
[[nodiscard]] std::optional<std::pair<Eigen::Vector2d, Eigen::Vector2d>> projectSegment(
    const Eigen::Vector3d& from_map, const Eigen::Vector3d& to_map, const PinholeView& view);

}  // namespace headway::render
