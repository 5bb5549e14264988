// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace headway::replay {

/// What a run reads and writes, by the command line of headway-replay or headway-live.
struct Options {
  std::string program = "headway-replay";  ///< name in messages
  std::vector<std::string> inputs;         ///< rawlogs; several of them get one map
  std::string input;                       ///< rawlog of the run, one of them
  std::string output;                      ///< folder
  std::string published;                   ///< where it will be in the end; empty: `output`
  std::string detections;                  ///< side file of boxes; empty: recorded boxes
  std::string detector;     ///< pipeline::DetectionParams::detector; empty: as configured
  std::string load_map;     ///< map file to continue; empty: new map
  std::string truth;        ///< folder with the truth for the report; empty: none
  std::string check_model;  ///< model to run on a bundled frame, instead of a replay
  std::string sensor_label;
  double realtime = 0.0;  ///< factor of the recorded rate; 0: offline, every frame
  std::optional<std::size_t> from_index;
  std::optional<std::size_t> to_index;
  std::optional<std::size_t> snapshots;  ///< pictures; see snapshotsOf()
  std::string theme;                     ///< of pictures and scene; empty: dark
  double checkpoint_s = 10.0;            ///< between checkpoints of map and trajectory; 0: none
  bool is_live = false;                  ///< live sensors: load is shed, no progress is shown
  bool overwrite = false;
  bool quiet = false;
  bool debug = false;  ///< print the decisions of each frame
};

/// Number of pictures to draw.
[[nodiscard]] inline std::size_t snapshotsOf(const Options& options) {
  return options.snapshots.value_or(6);
}

}  // namespace headway::replay
