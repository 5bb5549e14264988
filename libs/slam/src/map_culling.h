#pragma once

#include <optional>

#include "sparse_map.h"

namespace headway::slam {

/// Removes landmarks around the newest keyframe that are not worth their memory: those that are
/// looked for in vain, and those that only one keyframe has ever seen and that were passed.
///
/// @param window  newest keyframes whose landmarks may still be seen a second time
void cullLandmarks(KeyframeId newest, int window, SparseMap& map);

/// A keyframe near the newest one, but older than the `window` newest ones, that says nothing new:
/// nearly all of its landmarks are seen by several others from as near.
///
/// So a place that is passed again and again keeps a bounded number of keyframes, while one that
/// is passed once keeps what it has. The first keyframe, which holds the map in place, stays.
///
/// @return nullopt if there is none
/// @see Mur-Artal & Tardos 2015, sec. VI-E (survival of the fittest)
[[nodiscard]] std::optional<KeyframeId> redundantKeyframe(KeyframeId newest, int window,
                                                          const SparseMap& map);

/// Who takes over what hangs on a keyframe that is going to be removed: the one that shares most
/// landmarks with it, or the first one where none does.
[[nodiscard]] KeyframeId heirOf(KeyframeId keyframe, const SparseMap& map);

}  // namespace headway::slam
