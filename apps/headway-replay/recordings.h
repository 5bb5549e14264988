// SPDX-License-Identifier: BSD-3-Clause
// Several recordings of one camera, replayed into one map.
#pragma once

#include <headway/pipeline/perception.h>
#include <headway/program/files.h>

#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "replay.h"
#include "summary.h"

namespace headway::replay {

/// Replays several recordings of one camera into one map.
///
/// Each recording is a Replay of its own, with a folder of its own. After the last one their maps
/// are joined where they show the same places; then each folder is completed in the frame of the
/// joint map, which is written beside them: the one of most recordings. The other maps, of
/// recordings that share no place with these, are in `map-2`, `map-3` and so on.
///
///     Recordings(options, perception_params, params).run();
class Recordings {
 public:
  /// Opens all recordings, then prepares the folder.
  ///
  /// @param options  with several inputs
  /// @throws InputError if one cannot be opened, or if their cameras differ
  Recordings(const Options& options, const pipeline::PerceptionParams& perception_params,
             const Params& params);

  /// Processes all of them. After an error in one of them the others are processed and written.
  ///
  /// @throws InputError the first error, after writing the results
  void run();

 private:
  struct Recording {
    std::string input;
    std::string name;  ///< of its folder
    std::unique_ptr<Replay> replay;
    Pose T_map_run = Pose::Identity();  ///< see pipeline::JointMap
    std::optional<std::size_t> map;     ///< index of its map; nullopt: nothing was mapped
  };
  struct MapOfRecordings {
    std::filesystem::path folder;  ///< in the output folder; empty: that itself
    std::vector<std::size_t> recordings;
    std::size_t links = 0;
    std::size_t keyframes = 0;
    std::size_t landmarks = 0;
  };

  /// Satellite fixes of a map.
  struct MapFixes {
    std::size_t recorded = 0;
    std::size_t kept = 0;
    std::vector<geo::FixOnMap> on_map;  ///< in order of time
  };

  void processAll();
  void joinMaps();
  void place(const pipeline::JointMap& joint);
  void warnApart(const MapOfRecordings& map) const;
  void writeMap(pipeline::JointMap joint, MapOfRecordings& map);
  [[nodiscard]] MapFixes fixesOf(const MapOfRecordings& map) const;
  void writeGeo(const MapOfRecordings& map, const MapFixes& fixes) const;
  void complete();
  void writeRecord() const;
  void report() const;
  void keep(std::exception_ptr failure);
  /// @throws the failure, with where old and new results are
  [[noreturn]] void keepOldResults() const;
  [[nodiscard]] std::string namesOf(const MapOfRecordings& map) const;

  Options options_;
  std::vector<std::string> names_;
  program::OutputFolder folder_;
  std::vector<Recording> recordings_;
  std::vector<MapOfRecordings> maps_;
  std::exception_ptr failure_;     ///< the first one
  std::exception_ptr truncation_;  ///< the first one, of which all is written
};

}  // namespace headway::replay
