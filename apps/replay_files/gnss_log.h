// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/byte_archive.h>
#include <headway/core/recorded_frame.h>
#include <headway/geo/georeference.h>
#include <headway/slam/map_view.h>

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace headway::replay {

/// Name of the attachment of a map with the fixes that it was mapped with.
inline constexpr char kGnssAttachment[] = "gnss";

/// The fixes of a run, and of the runs before in a map that it loaded. Memory is bounded: above a
/// limit every second one is removed, and of those that follow, the same ratio is kept.
class GnssLog {
 public:
  static constexpr std::size_t kMaxFixes = 20000;

  explicit GnssLog(std::size_t max_fixes = kMaxFixes) : max_fixes_(max_fixes) {}

  void add(const std::vector<GnssFix>& fixes);

  /// Loads the fixes of the runs before, by gnssBytes().
  ///
  /// @param map  as it was stored with them
  /// @throws InputError if the bytes are cut off, damaged or of another version
  void load(const std::string& bytes, const slam::MapView& map);

  /// Fixes added and loaded, with those that are removed.
  [[nodiscard]] std::size_t added() const { return added_ + before_.size(); }
  /// Those of them that are kept.
  [[nodiscard]] std::size_t kept() const { return fixes_.size() + before_.size(); }

  /// The fixes with the antenna's position on the map, in order of time: those of this run between
  /// two tracked frames at most a second apart; those before move with the nearest keyframe that
  /// the map still has.
  [[nodiscard]] std::vector<geo::FixOnMap> onMap(const slam::TrajectoryVisit& trajectory,
                                                 const slam::MapView& map) const;

 private:
  std::size_t max_fixes_;
  std::vector<GnssFix> fixes_;
  std::size_t added_ = 0;
  std::size_t step_ = 1;
  std::vector<geo::FixOnMap> before_;  ///< of the runs before
  std::map<KeyframeId, Pose> loaded_;  ///< T_map_robot of the keyframes when they were loaded
};

/// Fixes as an attachment of a map; of more than GnssLog::kMaxFixes a part.
[[nodiscard]] std::string gnssBytes(std::vector<geo::FixOnMap> fixes);

}  // namespace headway::replay
