// SPDX-License-Identifier: BSD-3-Clause
// Reprojection errors of stereo measurements and their derivatives by point and pose.
#pragma once

#include <headway/core/pose.h>
#include <headway/core/stereo_camera.h>

#include <Eigen/Core>

namespace headway::stereo {

/// Tangent vector of a pose: (translation [m], rotation [rad]), both seen from the pose's frame.
using Tangent = Eigen::Matrix<double, 6, 1>;

/// The pose moved by xi: translation += R * xi_t, R *= exp(xi_r).
[[nodiscard]] Pose retract(const Pose& pose, const Tangent& xi);

/// The tangent vector that leads from one pose to another: retract(from, result) == to.
///
/// @param jacobian  6x6 d result / d xi for retract(to, xi), or null
[[nodiscard]] Tangent localCoordinates(const Pose& from, const Pose& to,
                                       Eigen::Matrix<double, 6, 6>* jacobian);

/// Inverse of SO(3)'s right Jacobian: log(exp(phi) exp(d)) = phi + result * d for small d.
///
/// @param phi  rotation vector [rad], shorter than pi
/// @see        Sola et al. 2018, "A micro Lie theory", eq. 144
[[nodiscard]] Eigen::Matrix3d inverseRightJacobian(const Eigen::Vector3d& phi);

/// Nearer points are not compared: their derivatives grow without bound [m].
inline constexpr double kMinDepth = 0.05;

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
