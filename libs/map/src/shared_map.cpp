#include <headway/map/shared_map.h>

namespace headway::map {

SharedMap::SharedMap() { places_[0].map = std::make_shared<const PerceptionMap>(); }

void SharedMap::publish(const PerceptionMap& map) {
  auto next = std::make_shared<const PerceptionMap>(map);
  const std::size_t current = current_;
  for (std::size_t i = 1;; ++i) {
    const std::size_t free = (current + i) % places_.size();
    if (free == current) continue;
    std::unique_lock lock(places_[free].mutex, std::try_to_lock);
    if (!lock) continue;  // a reader was sent there long ago and is still at it
    places_[free].map.swap(next);
    current_ = free;
    break;
  }
  // The map that was there before is freed here, with no lock held.
}

std::shared_ptr<const PerceptionMap> SharedMap::snapshot() const {
  const Place& place = places_[current_];
  const std::lock_guard lock(place.mutex);
  return place.map;
}

}  // namespace headway::map
