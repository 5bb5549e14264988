// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/geo/georeference.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "gnss_log.h"

namespace headway::replay {

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
