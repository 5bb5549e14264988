// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/slam/slam_params.h>

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

/// Recognises keyframes in the maps before their own one.
///
/// Each keyframe's landmarks are compared with those around the keyframes that resemble it most:
/// descriptors propose a pose, and the landmarks must then be measured where the other map's lie,
/// with the same disparity. Links that fewer than two others near them confirm, or that contradict
/// better confirmed ones, are left out.
///
/// @return by ascending keyframe
[[nodiscard]] std::vector<MapLink> findMapLinks(const SeparateMaps& maps,
                                                const StereoCamera& camera,
                                                const SlamParams& params);

/// The links that agree with each other: see findMapLinks().
///
/// @param links  by ascending keyframe
[[nodiscard]] std::vector<MapLink> consistentLinks(std::vector<MapLink> links,
                                                   const SeparateMaps& maps);

}  // namespace headway::slam
