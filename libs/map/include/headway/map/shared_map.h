#pragma once

#include <headway/map/perception_map.h>

#include <array>
#include <atomic>
#include <memory>
#include <mutex>

namespace headway::map {

/// The map that perception writes while others read it: a planner, a viewer, a logger.
///
/// One thread publishes whole maps, any number take snapshots that nobody changes. A map is
/// published into a place that no reader is sent to, so the writer does not wait for readers, not
/// even for one that was suspended while it took a snapshot. A reader never finds an older map
/// than it found before.
///
///     shared.publish(map);                       // perception, after each frame
///     const auto map = shared.snapshot();        // planner, any thread
///     const auto ask = map->at(now);
class SharedMap {
 public:
  SharedMap();

  /// Makes a map the current one. Copies a few pointers. For one thread at a time.
  void publish(const PerceptionMap& map);

  /// Back to an empty map, which queries answer as such. Snapshots stay as they are.
  void reset() { publish(PerceptionMap()); }

  /// The current map; never null, never changed.
  [[nodiscard]] std::shared_ptr<const PerceptionMap> snapshot() const;

 private:
  struct Place {
    mutable std::mutex mutex;
    std::shared_ptr<const PerceptionMap> map;  ///< guarded by mutex
  };

  std::array<Place, 4> places_;
  std::atomic<std::size_t> current_{0};  ///< where readers are sent; set by the writer alone
};

}  // namespace headway::map
