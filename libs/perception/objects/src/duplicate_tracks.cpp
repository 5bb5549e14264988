// SPDX-License-Identifier: BSD-3-Clause
#include "duplicate_tracks.h"

#include <algorithm>

#include "spatial_grid.h"

namespace headway::objects {
namespace {

/// Order of preference of tracks: by score, then by the lower id.
struct Candidate {
  Eigen::Vector3d position;
  MotionGroup group;
  double score;
};

}  // namespace

std::vector<const TrackedObject*> suppressDuplicateTracks(
    const std::vector<const TrackedObject*>& tracks, double distance_m) {
  if (distance_m <= 0.0) return tracks;
  std::vector<Candidate> candidates;
  candidates.reserve(tracks.size());
  for (const TrackedObject* track : tracks) {
    candidates.push_back({track->position(), track->group(), track->score()});
  }
  const SpatialGrid grid(candidates, distance_m);
  std::vector<const TrackedObject*> kept;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const Candidate& own = candidates[i];
    bool suppressed = false;
    grid.visitNear(own.position.head<2>(), [&](std::size_t j) {
      const Candidate& other = candidates[j];
      if (other.group == own.group) return;
      const bool better = other.score > own.score || (other.score == own.score && j < i);
      const double distance = (other.position - own.position).head<2>().norm();
      suppressed = suppressed || (better && distance < distance_m);
    });
    if (!suppressed) kept.push_back(tracks[i]);
  }
  return kept;
}

}  // namespace headway::objects
