// SPDX-License-Identifier: BSD-3-Clause
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

/// d (u, v, disparity) / d point_cam, the derivative of headway::project().
///
/// @param point_cam  in front of the camera [m]
/// @return           3x3 [px/m]
[[nodiscard]] Eigen::Matrix3d projectionJacobian(const Eigen::Vector3d& point_cam,
                                                 const StereoCamera& camera);

/// Weighted reprojection error: weights * (projection - uvd).
///
/// @param point_cam  in front of the camera [m]
/// @param uvd        measured left u, left v, disparity [px]
/// @param weights    inverse standard deviations [1/px]; 0 leaves a coordinate out
/// @param jacobian   3x3 d residual / d point_cam [1/m], or null
[[nodiscard]] Eigen::Vector3d stereoResidual(const Eigen::Vector3d& point_cam,
                                             const Eigen::Vector3d& uvd,
                                             const Eigen::Vector3d& weights,
                                             const StereoCamera& camera, Eigen::Matrix3d* jacobian);

/// The same for a measurement; the disparity's residual is 0 where it was not measured.
[[nodiscard]] Eigen::Vector3d stereoResidual(const Eigen::Vector3d& point_cam,
                                             const StereoMeasurement& measurement,
                                             const StereoCamera& camera, Eigen::Matrix3d* jacobian);

/// d point_cam / d xi for T_map_cam * exp(xi), xi = (translation, rotation).
[[nodiscard]] Eigen::Matrix<double, 3, 6> pointByPose(const Eigen::Vector3d& point_cam);

}  // namespace headway::stereo
