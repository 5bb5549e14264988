// SPDX-License-Identifier: BSD-3-Clause
#include "reference_choice.h"

#include "shared_view.h"

namespace headway::slam {
namespace {

/// Whether a frame shows so much of what a keyframe shows, and so little moved, that it needs no
/// keyframe of its own.
///
/// @param landmarks  of the frame, that count
bool isLike(const SharedView& view, std::size_t landmarks, const SlamParams& params,
            int image_width, const SparseMap& map) {
  const auto all = static_cast<double>(map.keyframe(view.keyframe).landmarks.size());
  return static_cast<double>(landmarks) >= params.keyframe_overlap * all &&
         view.flow_px <= params.keyframe_flow_ratio * image_width;
}

}  // namespace

std::optional<KeyframeId> referenceOf(const std::vector<TrackedLandmark>& landmarks,
                                      KeyframeId before, const SlamParams& params, int image_width,
                                      const SparseMap& map) {
  const SharedView shared = sharedView(before, landmarks, map);
  if (isLike(shared, static_cast<std::size_t>(shared.landmarks), params, image_width, map)) {
    return before;
  }
  const KeyframeId window = map.firstOfNewest(params.mapping ? params.window : 0);
  const auto is_old = [&](KeyframeId id) { return !window.valid() || id < window; };
  const auto old = nearestView(landmarks, map, is_old);
  if (!params.mapping) return old ? old->keyframe : before;
  if (old && isLike(*old, landmarks.size(), params, image_width, map)) return old->keyframe;
  return std::nullopt;
}

}  // namespace headway::slam
