// SPDX-License-Identifier: BSD-3-Clause
// The rectified stereo camera: calibration, projection, triangulation.
#pragma once

#include <headway/core/pose.h>

#include <Eigen/Core>
#include <optional>
#include <string>

namespace headway {

/// A rectified stereo pair: two pinhole cameras of the same intrinsics whose rows coincide.
///
/// Pixels have integer centres: (0, 0) is the centre of the top-left pixel. The camera frame is
/// that of the left camera: x right, y down, z forward. The right camera is at
/// (baseline_m, 0, 0). Invariant once validated: sizes, focal lengths and baseline are positive.
///
/// A depth camera is one whose disparities are given with its images: its baseline is that at which
/// a stereo camera's disparities would have the noise of the given ones.
///
///     StereoCamera camera = source.camera();
///     Eigen::Vector3d uvd = project(point_cam, camera).value();
struct StereoCamera {
  int width = 0;                          ///< [px]
  int height = 0;                         ///< [px]
  double fx = 0.0;                        ///< [px]
  double fy = 0.0;                        ///< [px]
  double cx = 0.0;                        ///< [px]
  double cy = 0.0;                        ///< [px]
  double baseline_m = 0.0;                ///< [m]
  Pose T_robot_cam = robotFromOptical();  ///< left camera on the robot
  double depth_reach_m = 0.0;  ///< of a depth camera: maximum depth measured; 0: stereo [m]

  [[nodiscard]] bool isDepthCamera() const { return depth_reach_m > 0.0; }
};

constexpr double kMaxMountingDistance_m = 100.0;  ///< of a camera from the origin of any robot

/// Throws InputError naming the first value that is invalid for a rectified pair.
void validate(const StereoCamera& camera);

/// Projects a point to the left image, with its disparity.
///
/// @param point  in the left camera frame [m]
/// @return       (left u, left v, disparity) [px]; nullopt if the point is not in front (z <= 0)
[[nodiscard]] std::optional<Eigen::Vector3d> project(const Eigen::Vector3d& point,
                                                     const StereoCamera& camera);

/// Triangulates one point from a rectified stereo match.
///
/// Its error along the ray grows with the square of the depth: sigma_z = z^2 / (f b) sigma_d.
///
/// @param uvd  left u, left v, disparity [px]
/// @return     point in the left camera frame [m]; nullopt if the disparity is not positive
/// @see        Hartley & Zisserman 2004, ch. 9: z = f b / d
[[nodiscard]] std::optional<Eigen::Vector3d> triangulate(const Eigen::Vector3d& uvd,
                                                         const StereoCamera& camera);

/// Unit-depth ray of a pixel: (x/z, y/z, 1) in the left camera frame.
[[nodiscard]] Eigen::Vector3d ray(const Eigen::Vector2d& uv, const StereoCamera& camera);

/// Both cameras in one line if images of one cannot be used with the other: size, focal lengths,
/// principal point or baseline differ by more than a calibration written with few digits does.
/// nullopt if they are the same. Their poses on the robot are not compared.
[[nodiscard]] std::optional<std::string> differenceBetween(const StereoCamera& other,
                                                           const StereoCamera& here);

}  // namespace headway
