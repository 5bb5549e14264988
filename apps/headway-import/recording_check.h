// SPDX-License-Identifier: BSD-3-Clause
// Checks of a recording, for all imports.
#pragma once

#include <headway/program/command_line.h>

#include <string>

namespace mrpt::obs {
class CObservation;
}

namespace headway::import {

/// Where an import writes: to a file, or with --check and without one, to a temporary file that is
/// removed at the end.
class ImportOutput {
 public:
  /// @throws UsageError if there is neither a path nor --check
  ImportOutput(std::string path, bool check);
  ~ImportOutput();
  ImportOutput(const ImportOutput&) = delete;
  ImportOutput& operator=(const ImportOutput&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::string folder_;  ///< temporary; empty: none
};

/// Whether an observation is an image, a pair of them or an image with depth.
[[nodiscard]] bool isAnyImage(const mrpt::obs::CObservation& observation);

/// Adds --check.
void addCheck(program::CommandLine& line, bool& check);

/// Checks a rawlog and prints a line for each item.
///
/// @param sensor_label  see io::RawlogSourceOptions
/// @return  program::kDone, or 1 if something is bad
int checkRawlog(const std::string& path, const std::string& sensor_label = "");

}  // namespace headway::import
