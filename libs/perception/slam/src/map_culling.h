// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "sparse_map.h"

namespace headway::slam {

/// Removes landmarks around the newest keyframe that are rarely found, and those that only one
/// keyframe outside of the window observes.
///
/// @param window  newest keyframes whose landmarks may still be seen a second time
void cullLandmarks(KeyframeId newest, int window, SparseMap& map);

/// A keyframe near the newest one, but older than the `window` newest ones, that is redundant:
/// nearly all of its landmarks are observed by several others from as near.
///
/// So a place that is passed again and again keeps a bounded number of keyframes, while one that
/// is passed once keeps what it has. The first keyframe, which holds the map in place, stays.
///
/// @return nullopt if there is none
/// @see Mur-Artal & Tardos 2015, sec. VI-E (survival of the fittest)
[[nodiscard]] std::optional<KeyframeId> redundantKeyframe(KeyframeId newest, int window,
                                                          const SparseMap& map);

/// The keyframe that frames anchored to `keyframe` are reassigned to when it is removed: the one
/// that shares most landmarks with it, or else the first one.
[[nodiscard]] KeyframeId replacementKeyframe(KeyframeId keyframe, const SparseMap& map);

}  // namespace headway::slam
