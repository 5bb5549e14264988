#pragma once

#include <headway/program/command_line.h>

#include <optional>
#include <string>

namespace headway::replay {

/// What the command line asks of a replay.
struct Options {
  std::string input;       ///< rawlog
  std::string output;      ///< folder
  std::string detections;  ///< side file of boxes; empty: those recorded in the rawlog
  std::string detector;    ///< pipeline::DetectionParams::detector; empty: as configured
  std::string load_map;    ///< map file to go on in; empty: begin a new map
  std::string truth;       ///< folder whose truth the report shows too; empty: none
  std::string sensor_label;
  double realtime = 0.0;  ///< times the recorded rate; 0: offline, every frame
  std::optional<std::size_t> from_index;
  std::optional<std::size_t> to_index;
  int snapshots = 6;
  bool overwrite = false;
  bool quiet = false;
};

/// Declares the options on a command line.
void describe(Options& options, program::CommandLine& line);

/// Throws UsageError where options contradict each other or make no sense.
void check(const Options& options);

}  // namespace headway::replay
