// SPDX-License-Identifier: BSD-3-Clause
// Maps of several runs, joined where they show the same places.
#pragma once

#include <headway/core/byte_archive.h>
#include <headway/slam/map_view.h>
#include <headway/slam/stereo_slam.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace headway::slam {

/// Part that one run has in a joint map.
struct JointMember {
  std::size_t run = 0;  ///< its index
  KeyframePoses poses;  ///< of its keyframes in the joint map, for StereoSlam::correct()
  std::int64_t keyframe_shift = 0;  ///< id in the joint map less id in its own map
};

/// The map of runs that have seen the same places, or of a single run.
struct JointMap {
  std::vector<JointMember> members;  ///< by ascending run; the frame is that of the first one
  std::size_t links = 0;             ///< keyframes that were recognised in the map of another run
  MapView view;
  ByteSource saved;  ///< as StereoSlam::snapshot()
};

/// Joins the maps of several runs with the same camera wherever these show the same places.
///
/// Keyframes are recognised in the other maps by the descriptors and positions of the landmarks
/// that they see; images are not needed. A recognition counts if others near it agree with it. The
/// maps are then moved onto each other by a pose graph, landmarks that are the same are fused, and
/// the whole is adjusted. Runs that share no place, directly or through others, get separate maps.
/// The runs themselves do not change.
///
/// The order of the runs decides the frame of each map, and nothing else.
///
/// @param runs  after their last frame and finish(), none null
/// @return      by ascending first member; each run is a member of one of them
/// @throws InputError if the cameras differ
[[nodiscard]] std::vector<JointMap> joinMaps(const std::vector<const StereoSlam*>& runs);

}  // namespace headway::slam
