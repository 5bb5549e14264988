// SPDX-License-Identifier: BSD-3-Clause
#include "map_culling.h"

#include <algorithm>

namespace headway::slam {
namespace {

constexpr int kReach = 3;  ///< windows of neighbours that are searched

/// Keyframes around the newest one that are not among the `window` newest, ascending.
std::vector<KeyframeId> olderNeighbours(KeyframeId newest, int window, const SparseMap& map) {
  std::vector<KeyframeId> around = map.neighbourhood(newest, kReach * window);
  const KeyframeId end = map.firstOfNewest(window);
  around.erase(std::lower_bound(around.begin(), around.end(), end), around.end());
  return around;
}

bool isRarelyFound(const Landmark& landmark) {
  constexpr int kTrial = 3;             ///< tries before a landmark is judged
  constexpr double kFoundShare = 0.25;  ///< of tries that must succeed
  return landmark.tried >= kTrial && landmark.found < kFoundShare * landmark.tried;
}

/// Whether enough other keyframes see a landmark from as near as this one does.
bool isObservedByOthers(const Landmark& landmark, const Keyframe& keyframe, const SparseMap& map) {
  constexpr int kOthers = 3;
  constexpr double kAsNear = 1.2;  ///< times the distance
  const auto distance = [&](const Keyframe& from) {
    return (landmark.position - from.T_map_cam.translation()).norm();
  };
  const double limit = kAsNear * distance(keyframe);
  int others = 0;
  for (const LandmarkObservation& observation : landmark.observations) {
    if (observation.keyframe == keyframe.id) continue;
    others += distance(map.keyframe(observation.keyframe)) <= limit ? 1 : 0;
  }
  return others >= kOthers;
}

bool isRedundant(const Keyframe& keyframe, const SparseMap& map) {
  constexpr double kOwnShare = 0.1;  ///< of its landmarks that others need not see as well
  const double allowed = kOwnShare * static_cast<double>(keyframe.landmarks.size());
  int own = 0;
  for (const LandmarkId id : keyframe.landmarks) {
    own += isObservedByOthers(*map.find(id), keyframe, map) ? 0 : 1;
    if (own > allowed) return false;
  }
  return !keyframe.landmarks.empty();
}

}  // namespace

void cullLandmarks(KeyframeId newest, int window, SparseMap& map) {
  std::vector<LandmarkId> culled;
  for (const LandmarkId id : map.seenBy(map.neighbourhood(newest, window))) {
    if (isRarelyFound(*map.find(id))) culled.push_back(id);
  }
  for (const LandmarkId id : map.seenBy(olderNeighbours(newest, window, map))) {
    if (map.find(id)->observations.size() == 1) culled.push_back(id);
  }
  for (const LandmarkId id : culled) {
    if (map.find(id) != nullptr) map.removeLandmark(id);
  }
}

std::optional<KeyframeId> redundantKeyframe(KeyframeId newest, int window, const SparseMap& map) {
  for (const KeyframeId id : olderNeighbours(newest, window, map)) {
    const bool is_first = id == map.keyframes().begin()->first;
    if (!is_first && isRedundant(map.keyframe(id), map)) return id;
  }
  return std::nullopt;
}

KeyframeId replacementKeyframe(KeyframeId keyframe, const SparseMap& map) {
  for (const KeyframeId id : map.neighbourhood(keyframe, 2)) {
    if (id != keyframe) return id;
  }
  return map.keyframes().begin()->first;
}

}  // namespace headway::slam
