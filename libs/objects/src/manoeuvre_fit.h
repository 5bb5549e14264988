#pragma once

#include <headway/objects/predictor.h>

#include <Eigen/Core>

namespace headway::objects {

/// How an object moves now, read off its recent path.
struct Manoeuvre {
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< of the velocity, unit length
  double speed = 0.0;                                    ///< [m/s]
  double acceleration = 0.0;                             ///< along the path [m/s^2]
  double turn_rate = 0.0;                                ///< [rad/s]
};

/// Fits a parabola through the newest place to the path before it.
///
/// Least squares with weights that fall off with age, and with what is typical of the class as a
/// prior: accelerations and turns are believed as far as they stand out of the noise. Slow motion
/// counts as less than it looks, since it may be noise of an object that stands.
///
/// @param history  one place at least
[[nodiscard]] Manoeuvre fitManoeuvre(const MotionHistory& history, const ManoeuvreParams& params);

}  // namespace headway::objects
