// SPDX-License-Identifier: BSD-3-Clause
// Satellite fixes of a run, and the files that place its map, path and tracks on the earth.
#pragma once

#include <headway/core/byte_archive.h>
#include <headway/core/recorded_frame.h>
#include <headway/geo/georeference.h>
#include <headway/slam/map_view.h>

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace headway::replay {

/// Name of the attachment of a map with the fixes that it was mapped with.
inline constexpr char kGnssAttachment[] = "gnss";

/// Greatest number of fixes, or of poses of a path, that are kept for files: half an hour at 10 Hz
/// in full, longer runs in steps.
inline constexpr std::size_t kMaxKept = 20000;

/// The fixes of a run, and of the runs before in a map that it loaded. Memory is bounded: above a
/// limit every second one is removed, and of those that follow, the same ratio is kept.
class GnssLog {
 public:
  explicit GnssLog(std::size_t max_fixes = kMaxKept) : max_fixes_(max_fixes) {}

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

/// Fixes as an attachment of a map; of more than kMaxKept a part.
[[nodiscard]] std::string gnssBytes(std::vector<geo::FixOnMap> fixes);

/// What a run's satellite fixes led to, for summary.json; empty without fixes.
struct GeoSummary {
  std::size_t fixes = 0;
  std::size_t without_pose = 0;                ///< of those used for the estimate
  std::optional<geo::Georeference> reference;  ///< nullopt: the map is not placed on the earth
  std::string reason;                          ///< why not
};

/// Places a map on the earth by fixes with their positions on it.
///
/// @param recorded  fixes, with those that were removed
/// @param kept      those that were not
[[nodiscard]] GeoSummary georeferenced(const std::vector<geo::FixOnMap>& fixes,
                                       std::size_t recorded, std::size_t kept);

/// One line for the end of a run.
[[nodiscard]] std::string describe(const GeoSummary& summary);

/// Writes map_geo.json: where the map lies on the earth.
void writeMapGeo(const std::filesystem::path& path, const GeoSummary& summary);

/// Writes trajectory.geojson: the robot's way, a line for each stretch without a lost frame.
void writeTrajectoryGeo(const std::filesystem::path& path, const geo::Georeference& reference,
                        const slam::TrajectoryVisit& visit);

/// Writes tracks.geojson from the folder's tracks_smoothed.csv: a line for each track. Positions
/// are moved with the robot's pose from the map as it was to the final one, by
/// trajectory_online.tum and trajectory.tum. Memory is bounded.
void writeTracksGeo(const std::filesystem::path& folder, const geo::Georeference& reference);

}  // namespace headway::replay
