// SPDX-License-Identifier: BSD-3-Clause
// What a run reads, writes and finds: its options, its figures, and replay.json and summary.json.
#pragma once

#include <headway/core/log.h>
#include <headway/core/params.h>
#include <headway/core/stage_times.h>
#include <headway/core/statistics.h>
#include <headway/core/track.h>
#include <headway/io/rawlog_source.h>
#include <headway/stereo/rig_capability.h>

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "geo_files.h"

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
  std::string get_model;    ///< model to download, instead of a replay
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

/// Numbers of frames, of which the first 100,000 are listed.
struct FrameList {
  std::size_t count = 0;
  std::vector<std::size_t> listed;

  void add(std::size_t frame) {
    if (count++ < 100000) listed.push_back(frame);
  }
};

/// Figures of one replay, written to summary.json.
struct Summary {
  std::size_t frames = 0;  ///< from the first frame's index to the last one's
  std::size_t frames_tracked = 0;
  FrameList lost_frames;                ///< lost or skipped
  FrameList unreliable_frames;          ///< with a pose that something contradicts
  FrameList new_submap_frames;          ///< of the tracked ones: in a submap that is not joined
  FrameList late_frames;                ///< in real time: dropped, or skipped, between others
  std::size_t frames_dropped_late = 0;  ///< with --realtime
  std::size_t keyframes = 0;
  std::size_t landmarks = 0;
  std::size_t submaps = 1;
  std::size_t loops = 0;
  std::size_t tracks_confirmed = 0;
  std::size_t tracks_moving = 0;  ///< confirmed tracks that were moving at some time
  double start_up_s = 0.0;
  double total_s = 0.0;
  Histogram frame_ms;
  double last_frame_ms = 0.0;
  double cpu_ms = 0.0;  ///< over all frames
  StageTimes stages;
  std::size_t detections_used = 0;
  std::string detector;             ///< as configured
  std::string image_detectors;      ///< that run where no boxes are recorded, joined by +
  bool has_recorded_boxes = false;  ///< in any frame
  DropCounts detections_dropped;
  std::optional<io::CalibrationReport> calibration;
  std::optional<stereo::RigCapability> rig;
  std::string rectification;  ///< of the right camera, in one line; empty: unknown
  Warnings warnings;
  std::map<std::string, std::size_t> laser;  ///< scans by use, and ends of beams
  std::optional<GeoSummary> geo;             ///< nullopt: no satellite fixes
  std::map<std::string, std::size_t> observations_skipped;
  std::optional<std::string> ended_early;  ///< reason if the rawlog was not read completely
  int seed = 0;
};

/// Time since the start of this process [s], which includes the time before main().
[[nodiscard]] double secondsSinceProcessStart();

/// Peak resident memory of this process [MB].
[[nodiscard]] double peakMemoryMb();

/// Writes replay.json: input, options and configuration of the run, what its rig can see, and the
/// file and SHA-256 of its network, if it has one.
void writeRunRecord(const std::filesystem::path& path, const Options& options, const Params& params,
                    const std::optional<stereo::RigCapability>& rig,
                    const std::string& detector_model = "");

/// Writes summary.json.
void writeSummary(const std::filesystem::path& path, const Summary& summary);

/// Prints the summary to standard output.
void printSummary(const Summary& summary);

}  // namespace headway::replay
