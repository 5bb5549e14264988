// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/program/command_line.h>

#include <cstddef>
#include <optional>
#include <string>

#include "options.h"

namespace headway::live {

/// Command-line options of a live run.
struct LiveOptions {
  replay::Options run;      ///< output, map to load and so on, as of a replay
  std::string sensors;      ///< .ini file of rawlog-grabber
  std::string plugins;      ///< shared libraries with drivers, separated by commas
  std::string calibration;  ///< file that replaces the drivers' calibration; empty: none
  std::string record;       ///< rawlog to write; empty: none
  std::optional<std::size_t> show_port;  ///< of the page; nullopt: none
  std::string show_address = "127.0.0.1";
  double pair_tolerance_s = 0.01;
};

/// Adds the options to a command line.
void describe(LiveOptions& options, program::CommandLine& line);

/// @throws UsageError if options are invalid or contradict each other
void check(const LiveOptions& options);

}  // namespace headway::live
