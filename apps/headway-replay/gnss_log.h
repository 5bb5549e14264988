// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/gnss_fix.h>
#include <headway/geo/georeference.h>
#include <headway/slam/map_view.h>

#include <cstddef>
#include <vector>

namespace headway::replay {

/// The fixes of a run. Memory is bounded: above a limit every second one is removed, and of those
/// that follow, the same ratio is kept.
class GnssLog {
 public:
  static constexpr std::size_t kMaxFixes = 20000;

  explicit GnssLog(std::size_t max_fixes = kMaxFixes) : max_fixes_(max_fixes) {}

  void add(const std::vector<GnssFix>& fixes);
  [[nodiscard]] const std::vector<GnssFix>& fixes() const { return fixes_; }
  /// Fixes added, with those that are removed.
  [[nodiscard]] std::size_t added() const { return added_; }

 private:
  std::size_t max_fixes_;
  std::vector<GnssFix> fixes_;
  std::size_t added_ = 0;
  std::size_t step_ = 1;
};

/// The fixes at times between two tracked frames at most a second apart, with the antenna's
/// position on the map, in order of time.
[[nodiscard]] std::vector<geo::FixOnMap> fixesOnMap(const std::vector<GnssFix>& fixes,
                                                    const slam::TrajectoryVisit& visit);

}  // namespace headway::replay
