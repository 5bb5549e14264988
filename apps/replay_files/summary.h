// SPDX-License-Identifier: BSD-3-Clause
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
#include "options.h"

namespace headway::replay {

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
