// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "landmark_tracker.h"
#include "sparse_map.h"

namespace headway::slam {

/// What a frame and a keyframe both see.
struct SharedView {
  KeyframeId keyframe;
  int landmarks = 0;     ///< of the frame's, seen by the keyframe, too
  double flow_px = 0.0;  ///< median distance of their places in both images
};

/// Compares the landmarks tracked in a frame with one keyframe.
[[nodiscard]] SharedView sharedView(KeyframeId keyframe,
                                    const std::vector<TrackedLandmark>& tracked,
                                    const SparseMap& map);

/// The keyframe that saw the frame's landmarks most nearly where they are now, among those that
/// share at least half as many as the one that shares most.
///
/// @param wanted  which keyframes are asked for
/// @return        nullopt if none of them sees any of the landmarks
[[nodiscard]] std::optional<SharedView> nearestView(const std::vector<TrackedLandmark>& tracked,
                                                    const SparseMap& map,
                                                    const std::function<bool(KeyframeId)>& wanted);

}  // namespace headway::slam
