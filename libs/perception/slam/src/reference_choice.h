// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/slam/slam_params.h>

#include <optional>
#include <vector>

#include "landmark_tracker.h"
#include "sparse_map.h"

namespace headway::slam {

/// The keyframe that a tracked frame belongs to, and from which the next frame is tracked.
///
/// That is the one before as long as the frame shows most of its landmarks, about where it saw
/// them. Else it is an older keyframe that saw the place from about here, if the frame finds as
/// many landmarks as that did, be they its own or those of other times: so a place that is passed
/// again needs no new keyframes. Without mapping, where no keyframe can be made, it is the nearest
/// that there is.
///
/// @param before       keyframe that the frame before belonged to
/// @param image_width  [px]
/// @return             nullopt if the frame is to become a keyframe itself
[[nodiscard]] std::optional<KeyframeId> referenceOf(const std::vector<TrackedLandmark>& landmarks,
                                                    KeyframeId before, const SlamParams& params,
                                                    int image_width, const SparseMap& map);

}  // namespace headway::slam
