// SPDX-License-Identifier: BSD-3-Clause
// The map as one thread publishes it and others read it.
#pragma once

#include <headway/map/perception_map.h>

#include <array>
#include <atomic>
#include <memory>
#include <mutex>

namespace headway::map {

/// The map, written by perception while other threads read it: planner, viewer, logger.
///
/// One thread publishes maps, any number of threads take immutable snapshots. A map is published
/// into a slot that no reader is directed to, so that the writer does not wait for readers, not
/// even for one that was suspended while taking a snapshot. Successive snapshots in one thread
/// never go back in time.
///
///     shared.publish(map);                       // perception, after each frame
///     const auto map = shared.snapshot();        // planner, any thread
///     const auto query = map->at(now);
class SharedMap {
 public:
  SharedMap();

  /// Replaces the current map. Copies a few pointers. To be called by one thread at a time.
  void publish(const PerceptionMap& map);

  /// Publishes an empty map, for which queries return kEmptyMap. Snapshots do not change.
  void reset() { publish(PerceptionMap()); }

  /// The current map; never null, never changed.
  [[nodiscard]] std::shared_ptr<const PerceptionMap> snapshot() const;

 private:
  struct Place {
    mutable std::mutex mutex;
    std::shared_ptr<const PerceptionMap> map;  ///< guarded by mutex
  };

  std::array<Place, 4> places_;
  std::atomic<std::size_t> current_{0};  ///< slot that readers use; set by the writer only
};

}  // namespace headway::map
