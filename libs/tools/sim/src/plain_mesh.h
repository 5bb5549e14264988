// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mesh.h"
#include "road_network.h"

namespace headway::sim {

/// Side of one picture of the meadow [m].
inline constexpr double kMeadowCell = 16.0;

/// A wide plain a little below the streets, for where no street is near.
///
/// @param corner  number of the cell below the camera, in x and y
/// @param anchor  what the mesh is relative to
[[nodiscard]] Mesh plainMesh(const RoadNetwork& network, const Eigen::Vector2i& corner,
                             const Eigen::Vector3d& anchor);

}  // namespace headway::sim
