// SPDX-License-Identifier: BSD-3-Clause
// Poses, rotations and the frames of robot and camera.
#pragma once

#include <Eigen/Geometry>
#include <cmath>

namespace headway {

/// Seconds since the Unix epoch (or since the start of a recording without absolute time).
///
/// The resolution of a double is 0.24 µs for current Unix times, finer than any camera's clock.
using Time = double;

inline constexpr double kDegree = M_PI / 180.0;  ///< [rad]

/// Rigid motion; a variable `T_a_b` maps points of frame b into frame a.
using Pose = Eigen::Isometry3d;

/// 6x6 covariance of a pose, in the order (translation [m], rotation [rad]).
///
/// The perturbation acts on the right: T = T_mean * exp(xi), so both parts are in the axes of the
/// frame whose pose it is.
using PoseCovariance = Eigen::Matrix<double, 6, 6>;

/// A value and its time [s].
template <typename T>
struct Stamped {
  Time time = 0.0;
  T value;
};

inline constexpr double kFrameJitter_s = 1e-6;  ///< by which times of frames are not exact [s]

/// The matrix [v]x with [v]x w = v x w.
[[nodiscard]] Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& v);

/// Rotation matrix of a rotation vector.
///
/// @param omega  axis times angle [rad]
/// @see          Sola et al. 2018, "A micro Lie theory", eq. 132 (Rodrigues)
[[nodiscard]] Eigen::Matrix3d expSo3(const Eigen::Vector3d& omega);

/// Rotation vector of a rotation matrix, angle in [0, pi]. Inverse of expSo3.
[[nodiscard]] Eigen::Vector3d logSo3(const Eigen::Matrix3d& rotation);

/// Unit quaternion of a pose's rotation.
[[nodiscard]] Eigen::Quaterniond quaternionOf(const Pose& pose);

/// The pose with its rotation re-orthonormalised, against drift in long chains of products.
[[nodiscard]] Pose normalized(const Pose& pose);

/// Whether a matrix is a rotation; files have as few as four decimals.
[[nodiscard]] bool isRotation(const Eigen::Matrix3d& matrix, double tolerance = 1e-3);

/// Whether it is a rigid motion by less than a distance along each axis [m].
[[nodiscard]] bool isRigid(const Pose& pose, double max_distance_m);

/// Of a place in a map, whose coordinates may be those of a UTM zone [m].
inline constexpr double kMaxMapCoordinate_m = 1e7;

/// Yaw of a pose's x axis about the z axis of the frame it is given in [rad], in (-pi, pi].
[[nodiscard]] double yawOf(const Pose& pose);

/// The equivalent angle in (-pi, pi] [rad].
[[nodiscard]] double wrapAngle(double angle);

/// Rotation from optical axes (x right, y down, z forward) to a robot's (x forward, y left, z up).
[[nodiscard]] Pose robotFromOptical();

}  // namespace headway
