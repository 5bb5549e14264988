// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/map/map_file.h>
#include <headway/pipeline/run_state.h>
#include <headway/slam/trajectory_record.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gnss_log.h"
#include "options.h"
#include "summary.h"

namespace headway::replay {

/// Name of the attachment of a checkpoint's map with pipeline::Perception::runState().
inline constexpr char kRunAttachment[] = "run";

/// Name of the attachment with the ProgramState.
inline constexpr char kProgramAttachment[] = "replay";

/// What a checkpoint contains of the program's state.
struct ProgramState {
  /// A confirmed track that may not have ended.
  struct SeenTrack {
    Time last_seen = 0.0;
    bool was_moving = false;  ///< at some time
  };

  Summary summary;  ///< its counts, without times
  std::optional<std::size_t> next_frame;
  std::map<TrackId, SeenTrack> seen_tracks;
  std::map<std::string, std::size_t> rows;  ///< of each growing file
  GnssLog gnss;
};

[[nodiscard]] std::string packed(const ProgramState& state);

/// The last checkpoint of a run that was killed.
struct Continuation {
  std::filesystem::path folder;  ///< where the run wrote, OUTDIR or OUTDIR/unfinished
  map::StoredMap map;
  std::string run;  ///< for Perception::continueRun()
  pipeline::RunExtent extent;
  ProgramState state;
};

/// Takes input, options and configuration of the run in a folder from its replay.json, and its
/// last checkpoint. A run without a checkpoint starts again: then `overwrite` is set instead.
///
/// @param folder  output of the run, which becomes the output of this one
/// @throws InputError if it contains no run, or one that has ended
void continueRun(const std::filesystem::path& folder, Options& options, Params& params);

/// The steps of the run's trajectory. @throws InputError if their file cannot be read
[[nodiscard]] slam::TrajectoryReader trajectoryOf(const Continuation& run);

/// Positions on the way so far, for pictures of the map.
[[nodiscard]] std::vector<Stamped<Pose>> onlinePath(const std::filesystem::path& folder,
                                                    std::size_t rows);

}  // namespace headway::replay
