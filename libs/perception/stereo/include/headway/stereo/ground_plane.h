// SPDX-License-Identifier: BSD-3-Clause
// The ground: its plane in the camera frame, and disparities that are matched along it.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/rig_capability.h>

#include <algorithm>
#include <optional>

namespace headway::stereo {

/// What is lower than this ratio of the minimum obstacle height is ground, by stereo and by lasers.
inline constexpr double kGroundRatio = 0.5;

/// The ground before the camera, as a plane in the camera frame.
///
/// Defines what is ground for the search of the plane, the grid, the detection of moving objects
/// and the lifting of boxes: what is not higher than half of the lowest obstacle, or than the
/// noise. A matched point of the ground has three errors of its height: the roughness of the
/// ground, the tilt of the plane, and the depth error z^2 s / (f b), which a ray that descends by H
/// / z turns into z s H / (f b).
struct GroundPlane {
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();  ///< unit normal, away from the ground
  double camera_height = 0.0;                      ///< of the camera above it [m]
  double sigma_per_m = 0.0024;  ///< errors of a height by disparity and tilt, per depth [m/m]
  double clearance_m = 0.15;    ///< minimum height of what is not ground, noise aside [m]

  /// Height of a point above the ground [m].
  [[nodiscard]] double heightOf(const Eigen::Vector3d& point) const {
    return up.dot(point) + camera_height;
  }
  /// Standard deviation of the height of a matched point of the ground [m].
  [[nodiscard]] double heightSigma(double depth) const;
  /// Maximum distance of matched points of the ground from the plane: three sigmas [m].
  [[nodiscard]] double tolerance(double depth) const { return 3.0 * heightSigma(depth); }
  /// Height from which a point at a depth is not ground [m].
  [[nodiscard]] double clearance(double depth) const {
    return std::max(clearance_m, tolerance(depth));
  }
  /// Whether a point is on the ground or below it.
  [[nodiscard]] bool isGround(const Eigen::Vector3d& point) const {
    return heightOf(point) <= clearance(point.z());
  }
};

/// The plane with the noise and the clearance of a rig: half of its minimum obstacle height.
///
/// @param up  unit normal, camera frame
[[nodiscard]] GroundPlane groundPlane(const RigCapability& rig, const Eigen::Vector3d& up,
                                      double camera_height);

/// Direction against gravity in the camera frame, as the camera is mounted on its robot.
[[nodiscard]] Eigen::Vector3d mountedUp(const StereoCamera& camera);

/// Finds the ground in a disparity image: the plane with most of the near points on it and
/// hardly any below it, that is tilted by less than 10 degrees against the mounting, and 0.2 ... 4
/// m below the camera (less for a camera mounted lower than 0.4 m). Sampled with a fixed seed.
///
/// @param previous  plane of the frame before, tried first
/// @return          nullopt where no plane carries enough points (expected, not an error)
/// @see             Fischler & Bolles 1981 (RANSAC)
[[nodiscard]] std::optional<GroundPlane> findGround(const DisparityImage& disparity,
                                                    const StereoCamera& camera,
                                                    const std::optional<GroundPlane>& previous);

/// Finds a floor without knowing the mounting: the largest plane that nothing lies below, less than
/// 45 degrees from level as the camera is mounted, at any height below it.
///
/// @return  nullopt where none is seen (expected, not an error)
[[nodiscard]] std::optional<GroundPlane> findFloor(const DisparityImage& disparity,
                                                   const StereoCamera& camera);

/// Matches the ground of a stereo pair along its plane, on the grid of denseDisparity().
///
/// From one row of an image to the next, the disparity of the ground changes by b / h: within a
/// block it differs by pixels, so that block matching gives nothing for half of the ground, and for
/// the rest the disparity of one of the block's rows. Here the right image is sheared first, which
/// makes the plane's disparity zero everywhere; blocks are then matched within a few pixels of it.
///
/// @param ground  of the frame
/// @param to_m    maximum depth of the result [m]
/// @return        disparities [px of the full image] of what is within the plane's tolerance, else
///                0; all 0 for a depth camera, and where the ground is not in the image
/// @see  Gallup et al. 2007, "Real-time plane-sweeping stereo with multiple sweeping directions"
[[nodiscard]] DisparityImage groundDisparity(const StereoFrame& frame, const GroundPlane& ground,
                                             const DisparityParams& params, double to_m);

}  // namespace headway::stereo
