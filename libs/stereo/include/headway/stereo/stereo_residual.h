#pragma once

#include <headway/core/pose.h>
#include <headway/core/stereo_camera.h>

#include <Eigen/Core>

namespace headway::stereo {

/// One landmark as measured in one frame.
struct StereoMeasurement {
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();  ///< left image [px]
  double disparity = 0.0;                        ///< [px], only meaningful where stereo
  bool stereo = false;                           ///< found in the right image, too
  double sigma_px = 1.0;                         ///< of u and v
  double sigma_disparity_px = 1.0;               ///< of the disparity
};

/// Residual (u, v, disparity) of a point in the camera, each divided by its sigma; the disparity's
/// is 0 where it was not measured.
///
/// @param point_cam  in front of the camera [m]
/// @param jacobian   d residual / d point_cam, or null
[[nodiscard]] Eigen::Vector3d stereoResidual(const Eigen::Vector3d& point_cam,
                                             const StereoMeasurement& measurement,
                                             const StereoCamera& camera, Eigen::Matrix3d* jacobian);

/// d point_cam / d xi for T_map_cam * exp(xi), xi = (translation, rotation).
[[nodiscard]] Eigen::Matrix<double, 3, 6> pointByPose(const Eigen::Vector3d& point_cam);

/// The pose moved by xi = (translation [m], rotation [rad]) as seen from itself.
[[nodiscard]] Pose retract(const Pose& pose, const Eigen::Matrix<double, 6, 1>& xi);

}  // namespace headway::stereo
