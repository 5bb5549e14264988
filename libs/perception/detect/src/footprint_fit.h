// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>
#include <headway/core/stereo_camera.h>
#include <headway/detect/surface_depth.h>

#include <vector>

namespace headway::detect {

/// A rectangle of known size on the ground, placed so that it explains what stereo saw of it.
struct FittedFootprint {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< (x, z), camera frame [m]
  double yaw = 0.0;  ///< KITTI's rotation_y, front taken to look away from the camera [rad]
  /// Of the centre (x, z): what the headings that explain it as well leave open [m^2].
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
};

/// Places an upright box of known length and width behind the surface seen in an image box.
///
/// For each heading the box is put where its sides, seen from the camera, have the depths measured
/// in the columns of the image box, and its outline the image box's edges (those not cut by the
/// image). The heading with the least robust error wins: the visible side's slope decides, and the
/// width of the image box where that is unclear.
///
/// @param edge_sigma  of each of the image box's edges [px]
/// @param size     length and width [m]
/// @param surface  depth of the visible surface
[[nodiscard]] FittedFootprint fitFootprint(const Box2d& box, double edge_sigma,
                                           const Eigen::Vector2d& size, const SurfaceDepth& surface,
                                           const std::vector<DisparitySample>& samples,
                                           const StereoCamera& camera);

}  // namespace headway::detect
