#pragma once

#include <headway/core/track.h>

#include <vector>

namespace headway::scene {

/// The tracks that are believed: confirmed and coasting ones.
[[nodiscard]] inline std::vector<const Track*> shownTracks(const std::vector<Track>& tracks) {
  std::vector<const Track*> shown;
  for (const auto& track : tracks) {
    if (isShown(track)) shown.push_back(&track);
  }
  return shown;
}

}  // namespace headway::scene
