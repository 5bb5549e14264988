// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

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

}  // namespace headway::stereo
