#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/stereo/disparity.h>

#include <optional>

namespace headway::stereo {

/// The ground before the camera, as a plane in the camera frame.
struct GroundPlane {
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();  ///< unit normal, away from the ground
  double camera_height = 0.0;                      ///< of the camera above it [m]

  /// Height of a point above the ground [m].
  [[nodiscard]] double heightOf(const Eigen::Vector3d& point) const {
    return up.dot(point) + camera_height;
  }
};

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

}  // namespace headway::stereo
