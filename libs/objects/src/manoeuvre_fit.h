#pragma once

#include <headway/objects/predictor.h>

#include <Eigen/Core>

namespace headway::objects {

/// How an object moves now, read off its recent path.
struct Manoeuvre {
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();           ///< of the velocity, unit length
  double speed = 0.0;                                             ///< [m/s]
  double acceleration = 0.0;                                      ///< along the path [m/s^2]
  double turn_rate = 0.0;                                         ///< [rad/s]
  Eigen::Matrix2d velocity_covariance = Eigen::Matrix2d::Zero();  ///< [m^2/s^2]
};

/// Fits a parabola through the newest place to the path before it.
///
/// Least squares with weights that fall off with age, and with what is typical of the class as a
/// prior: accelerations and turns are believed as far as they stand out of the noise. Slow motion
/// counts as less than it looks, since it may be noise of an object that stands. The covariance of
/// the velocity tells how short or noisy the path is: an error of the newest place, through which
/// the parabola goes, tilts all of it; those of the places before and the prior come on top.
///
/// @param history  one place at least
[[nodiscard]] Manoeuvre fitManoeuvre(const MotionHistory& history, const ManoeuvreParams& params);

}  // namespace headway::objects
