// SPDX-License-Identifier: BSD-3-Clause
// Joining maps: keyframes that are recognised in another map, the links that agree, and the map of
// both.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/slam/slam_params.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "sparse_map.h"

namespace headway::slam {

/// Several maps in one, not connected with each other.
struct SeparateMaps {
  SparseMap all;
  std::vector<KeyframeId> first;  ///< keyframe of each map, ascending; a map has the ids up to the
                                  ///< next map's first

  /// Index of the map that a keyframe belongs to.
  [[nodiscard]] std::size_t mapOf(KeyframeId keyframe) const;
};

/// A keyframe that was recognised in another map.
struct MapLink {
  KeyframeId keyframe;
  KeyframeId place;                          ///< the other map's keyframe that it resembles
  Pose T_place_keyframe = Pose::Identity();  ///< cameras
  std::vector<std::pair<LandmarkId, LandmarkId>> landmarks;  ///< (the other map's, the keyframe's)
};

/// The links that agree with each other: those that two others near them confirm, without those
/// that contradict better confirmed ones.
///
/// @param links  by ascending keyframe
[[nodiscard]] std::vector<MapLink> consistentLinks(std::vector<MapLink> links,
                                                   const SeparateMaps& maps);

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

}  // namespace headway::slam
