// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace headway::detect {

/// The part of a vector that lies along the ground.
///
/// @param up  unit normal of the ground
inline Eigen::Vector3d overGround(const Eigen::Vector3d& vector, const Eigen::Vector3d& up) {
  return vector - up * up.dot(vector);
}

}  // namespace headway::detect
