// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/objects/predictor.h>

#include <Eigen/Core>
#include <cstddef>

namespace headway::objects {

/// Current motion of an object, estimated from its recent path.
struct Manoeuvre {
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();           ///< of the velocity, unit length
  double speed = 0.0;                                             ///< [m/s]
  double acceleration = 0.0;                                      ///< along the path [m/s^2]
  double turn_rate = 0.0;                                         ///< [rad/s]
  Eigen::Matrix2d velocity_covariance = Eigen::Matrix2d::Zero();  ///< [m^2/s^2]
};

/// Fits a parabola through the newest position to the path before it.
///
/// Least squares with weights that decrease with age, and with typical values of the class as a
/// prior, which limits accelerations and turns to those significant against the noise. Low speeds
/// are reduced, since they may be noise of a static object. The covariance of the velocity contains
/// the error of the newest position, which rotates the parabola that passes through it, the errors
/// of the earlier positions, the prior, and that what stands may set off.
///
/// @param seen  number of the first positions that are used, at least one: with fewer than all, the
///              motion as it was known at the last of them
[[nodiscard]] Manoeuvre fitManoeuvre(const MotionHistory& history, std::size_t seen,
                                     const ManoeuvreParams& params);

}  // namespace headway::objects
