// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/object_class.h>

#include <Eigen/Core>
#include <optional>

namespace headway::detect {

/// How large objects of a class usually are.
struct ClassSize {
  Eigen::Vector3d size = Eigen::Vector3d::Ones();  ///< (length, width, height) [m]
  double spread = 0.1;  ///< standard deviation of the height, ratio to it [-]
};

/// What is known of a class's size; nullopt for Unknown and Misc, which may be anything.
///
/// @see  Geiger et al. 2012: means over the boxes of the KITTI benchmark
[[nodiscard]] std::optional<ClassSize> classSize(ObjectClass object_class);

}  // namespace headway::detect
