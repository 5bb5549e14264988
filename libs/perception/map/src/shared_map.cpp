// SPDX-License-Identifier: BSD-3-Clause
// The map as one thread publishes it and others read it.
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
    if (!lock) continue;  // a slow reader still holds this slot
    places_[free].map.swap(next);
    current_ = free;
    break;
  }
  // The previous map of the slot is freed here, without a lock.
}

std::shared_ptr<const PerceptionMap> SharedMap::snapshot() const {
  const Place& place = places_[current_];
  const std::lock_guard lock(place.mutex);
  return place.map;
}

}  // namespace headway::map
