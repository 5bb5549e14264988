// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/slam/slam_params.h>

#include <cstdint>
#include <vector>

#include "map_links.h"
#include "sparse_map.h"

namespace headway::slam {

/// Maps that share places, as one.
struct JointSparseMap {
  std::vector<std::size_t> members;  ///< indices of the maps, ascending
  std::vector<std::int64_t> shifts;  ///< of each member: id of a keyframe here less its own id
  std::size_t links = 0;             ///< keyframes that were recognised in another map
  SparseMap map;                     ///< in the frame of the first member
};

/// Joins maps wherever they show the same places; see joinMaps().
[[nodiscard]] std::vector<JointSparseMap> joinSparseMaps(const std::vector<const SparseMap*>& maps,
                                                         const StereoCamera& camera,
                                                         const SlamParams& params);

/// Moves maps onto each other by the links between them, fuses landmarks that are the same, and
/// adjusts the whole.
void joinByLinks(const std::vector<MapLink>& links, const StereoCamera& camera, SeparateMaps& maps,
                 const StopCondition& stop = neverStop);

}  // namespace headway::slam
