// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <vector>

#include "landmark_tracker.h"
#include "pose_graph.h"
#include "sparse_map.h"

namespace headway::slam {

/// A verified loop: the newest keyframe as an old one's surroundings see it.
struct ClosedLoop {
  KeyframeId newest;
  KeyframeId old;
  Pose T_old_newest = Pose::Identity();  ///< cameras
  std::vector<TrackedLandmark>
      landmarks;  ///< of the old one's surroundings, measured in the newest
};

/// Whether two consecutive keyframes share no landmark: the camera was lost between them, so their
/// relative pose is only predicted.
[[nodiscard]] bool shareNoLandmarks(const Keyframe& a, const Keyframe& b);

/// Edges of the map as it is: from each keyframe to the one before (where both share nothing
/// because the camera was lost between them, with the uncertainty of wheel odometry, or a weak one)
/// and to those that share many landmarks.
[[nodiscard]] std::vector<PoseGraphEdge> edgesOf(const std::map<KeyframeId, Keyframe>& keyframes);

/// Copies of the keyframes that a loop may move: those of both submaps.
[[nodiscard]] std::map<KeyframeId, Keyframe> keyframesOfLoop(KeyframeId newest, KeyframeId old,
                                                             const SparseMap& map);

/// Poses of all keyframes after the loop was distributed over the pose graph.
[[nodiscard]] std::map<KeyframeId, Pose> posesWithLoop(
    const std::map<KeyframeId, Keyframe>& keyframes, const ClosedLoop& loop,
    const StopCondition& stop = neverStop);

/// The same after several loops; their landmarks are not used.
[[nodiscard]] std::map<KeyframeId, Pose> posesWithLoops(
    const std::map<KeyframeId, Keyframe>& keyframes, const std::vector<ClosedLoop>& loops,
    const StopCondition& stop = neverStop);

/// Replaces poses of keyframes and moves the landmarks of which they are the reference.
void applyCorrection(const std::map<KeyframeId, Pose>& corrected, SparseMap& map);

/// Adds the loop's measurements to the newest keyframe, which must be in the map.
void observeLoop(const ClosedLoop& loop, SparseMap& map);

}  // namespace headway::slam
