// SPDX-License-Identifier: BSD-3-Clause
// The output folder of a replay as the report reads it.
#pragma once

#include <headway/core/object_class.h>
#include <headway/core/pose.h>
#include <headway/report/map_files.h>

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <vector>

namespace headway::report {

/// State of a track at one frame.
struct TrackPoint {
  double time = 0.0;      ///< [s]
  double x = 0.0;         ///< map frame [m]
  double y = 0.0;         ///< map frame [m]
  bool confirmed = true;  ///< false: coasting
  bool moving = false;
};

/// All states of one track, ascending in time.
struct TrackHistory {
  std::int64_t id = -1;
  ObjectClass object_class = ObjectClass::kUnknown;
  std::vector<TrackPoint> points;  ///< at least one
};

/// The files of a finished replay that the report shows.
struct ReplayFolder {
  std::filesystem::path path;
  nlohmann::ordered_json summary;                ///< summary.json
  nlohmann::ordered_json record;                 ///< replay.json; null if missing
  std::vector<Stamped<Pose>> trajectory;         ///< robot in map; of long runs a sample
  std::vector<TrackHistory> tracks;              ///< at its times; by first time, then id
  std::size_t track_step = 1;                    ///< of these times every so manieth alone
  std::vector<ColouredPoint> landmarks;          ///< a sample
  std::optional<GridFile> grid;                  ///< map_grid.yaml; nullopt without a grid
  std::vector<std::filesystem::path> snapshots;  ///< by name
};

/// @throws InputError if the folder contains results of two runs, because one was killed while it
///         replaced those of the other
void requireOneRun(const std::filesystem::path& folder);

/// Reads the folder; files other than summary.json may be missing.
///
/// @throws InputError if summary.json is missing, a file is malformed, or as requireOneRun()
[[nodiscard]] ReplayFolder readReplayFolder(const std::filesystem::path& path);

/// Every `step`-th pose of a trajectory.
struct ThinnedPath {
  std::vector<Stamped<Pose>> poses;
  std::size_t step = 1;
};

/// Reads a trajectory of any length, thinned out to at most `max_poses`.
///
/// @throws InputError naming file and line of an error
[[nodiscard]] ThinnedPath readPath(const std::filesystem::path& path, std::size_t max_poses);

/// Tracks at every `step`-th time.
struct ThinnedTracks {
  std::vector<TrackHistory> tracks;
  std::size_t step = 1;
};

/// Reads the tracks of a file with the columns of `tracks.csv`, of any length, thinned out to
/// 50,000 states.
///
/// @param times  of the states that are read [s]; empty: all
/// @throws InputError naming file and line of an error
[[nodiscard]] ThinnedTracks readTracks(const std::filesystem::path& path,
                                       const std::set<double>& times = {});

/// Reads a file of one JSON object. @throws InputError if it is none, or nested too deeply
[[nodiscard]] nlohmann::ordered_json readJson(const std::filesystem::path& path);

}  // namespace headway::report
