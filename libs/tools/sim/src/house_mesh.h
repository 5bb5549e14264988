// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "facade_texture.h"
#include "mesh.h"
#include "occlusion.h"

namespace headway::sim {

struct HousePlan {
  FacadePlan facade;
  double ridge_m = 0.0;  ///< height of the roof above the walls; 0: flat
};

/// The walls of a house as a block.
[[nodiscard]] Block houseBlock(const HousePlan& plan, const Eigen::Vector3f& foot, float yaw);

/// A house whose front's foot has its middle at `foot`; the front faces to the right of `yaw`.
[[nodiscard]] Mesh houseMesh(const HousePlan& plan, const Eigen::Vector3f& foot, float yaw);

}  // namespace headway::sim
