// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/random.h>

#include <algorithm>
#include <cmath>

namespace headway::sim {

/// One axis of a vehicle's damped springs, shaken by the ground.
struct Suspension {
  double angle = 0.0;  ///< [rad]
  double rate = 0.0;   ///< [rad/s]

  /// @param shake_rad  standard deviation of the angle in the long run, at `motion` = 1
  /// @param motion     0 at a standstill, 1 at full speed
  /// @param rest_rad   angle at which the springs are at rest, such as a nod while braking
  void advance(double dt, double shake_rad, double motion, double rest_rad, Random& random) {
    constexpr double kStiffness = 2.0 * M_PI * 1.2, kDamping = 0.35;  // [1/s], [-]
    const double shake =
        shake_rad * std::sqrt(4.0 * kDamping * std::pow(kStiffness, 3) / dt) * motion;
    const double acceleration = -kStiffness * kStiffness * (angle - rest_rad) -
                                2.0 * kDamping * kStiffness * rate + shake * random.normal();
    rate += dt * acceleration;
    angle += dt * rate;
  }
};

}  // namespace headway::sim
