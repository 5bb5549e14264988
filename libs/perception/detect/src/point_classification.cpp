// SPDX-License-Identifier: BSD-3-Clause
#include "point_classification.h"

#include <cmath>

#include "over_ground.h"

namespace headway::detect {
namespace {

constexpr double kGoodFit = 3.0;  // squared error to a degree of freedom
constexpr double kBadFit = 6.0;

}  // namespace

PointClass classifyPoint(const PointTrack& point, const Eigen::Vector3d& up,
                         const PointClassParams& params) {
  if (!point.motion || point.motion->observations < params.min_observations) {
    return PointClass::kUnknown;
  }
  const PointMotion& motion = *point.motion;
  const double static_fit = motion.staticFit();
  const double moving_fit = motion.movingFit();
  if (moving_fit > kBadFit && static_fit > kBadFit) return PointClass::kMismatch;
  const Eigen::Vector3d along_ground = overGround(motion.velocity, up);
  const double speed = along_ground.norm();
  const Eigen::Vector3d direction = along_ground / std::max(1e-9, speed);
  const double sigma = std::sqrt(direction.dot(motion.velocity_covariance * direction));
  const bool significant = motion.static_error - motion.moving_error > params.significance &&
                           speed > params.speed_sigmas * sigma;
  const bool possible =
      speed > params.min_speed && speed < params.max_speed && motion.velocity.norm() < 2.0 * speed;
  if (significant && possible && moving_fit < kGoodFit) return PointClass::kMoving;
  return static_fit < kGoodFit ? PointClass::kStatic : PointClass::kUnknown;
}

}  // namespace headway::detect
