#pragma once

#include <headway/core/object_class.h>

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "text_table.h"

namespace headway::report {

/// One track at one frame, as a plot needs it.
struct TrackPoint {
  double time = 0.0;      ///< [s]
  double x = 0.0;         ///< [m]
  double y = 0.0;         ///< [m]
  bool confirmed = true;  ///< false: coasting
  bool moving = false;
};

/// One track over its life, ascending in time.
struct TrackLife {
  std::int64_t id = -1;
  ObjectClass object_class = ObjectClass::kUnknown;
  std::vector<TrackPoint> points;
};

/// What the folder of a finished replay holds, as far as the page shows it.
struct ReplayFolder {
  std::filesystem::path path;
  nlohmann::ordered_json summary;
  nlohmann::ordered_json record;  ///< replay.json; null if missing
  std::vector<TimedPlace> trajectory;
  std::vector<TrackLife> tracks;                 ///< by first sight, then id
  std::vector<Eigen::Vector3f> landmarks;        ///< a sample
  std::vector<std::filesystem::path> snapshots;  ///< in order of name
};

/// @throws InputError if summary.json is missing or a file is broken
[[nodiscard]] ReplayFolder readReplayFolder(const std::filesystem::path& path);

/// The lives of the tracks in a file with the columns of `tracks.csv`.
[[nodiscard]] std::vector<TrackLife> readTracks(const std::filesystem::path& path);

}  // namespace headway::report
