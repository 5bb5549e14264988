#include "rivals.h"

#include <algorithm>

#include "spatial_grid.h"

namespace headway::objects {
namespace {

/// What decides between two tracks; the lesser id where the scores are equal.
struct Contender {
  Eigen::Vector3d position;
  MotionGroup group;
  double score;
};

}  // namespace

std::vector<const TrackedObject*> withoutRivals(const std::vector<const TrackedObject*>& tracks,
                                                double distance_m) {
  if (distance_m <= 0.0) return tracks;
  std::vector<Contender> contenders;
  contenders.reserve(tracks.size());
  for (const TrackedObject* track : tracks) {
    contenders.push_back({track->position(), track->group(), track->score()});
  }
  const SpatialGrid grid(contenders, distance_m);
  std::vector<const TrackedObject*> kept;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const Contender& own = contenders[i];
    bool outranked = false;
    grid.visitNear(own.position.head<2>(), [&](std::size_t j) {
      const Contender& other = contenders[j];
      if (other.group == own.group) return;
      const bool surer = other.score > own.score || (other.score == own.score && j < i);
      const double distance = (other.position - own.position).head<2>().norm();
      outranked = outranked || (surer && distance < distance_m);
    });
    if (!outranked) kept.push_back(tracks[i]);
  }
  return kept;
}

}  // namespace headway::objects
