// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

#include <cmath>

namespace headway::sim {

/// Rotation about the robot's left axis, positive nose down, and about its front axis [rad].
inline double pitchOf(const Pose& pose) { return std::asin(-pose.linear()(2, 0)); }
inline double rollOf(const Pose& pose) {
  return std::atan2(pose.linear()(2, 1), pose.linear()(2, 2));
}

}  // namespace headway::sim
