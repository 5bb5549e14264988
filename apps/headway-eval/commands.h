// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/program/command_line.h>

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace headway::app {

/// Sub-commands of headway-eval; each parses its arguments and returns the exit status.
int runTrajectory(int argc, const char** argv);
int runTracks(int argc, const char** argv);
int runMovers(int argc, const char** argv);
int runPredictions(int argc, const char** argv);
int runGrid(int argc, const char** argv);
int runDense(int argc, const char** argv);
int runSuite(int argc, const char** argv);

/// Name of a result in titles, with the folder of its recording: "street/trajectory.tum".
[[nodiscard]] std::string recordingName(const std::string& path);

/// Options for output files, common to all sub-commands.
class Outputs {
 public:
  /// Adds the options --json, --plot and -w.
  void describe(program::CommandLine& line);

  /// @param inputs  files that are read
  /// @throws InputError if a file exists and -w is not given, or is an input
  void requireWritable(const std::vector<std::string>& inputs) const;

  /// Computes and writes only the requested files.
  ///
  /// @throws InputError if a file cannot be written
  void write(const std::function<nlohmann::ordered_json()>& figures,
             const std::function<cv::Mat()>& plot) const;

  [[nodiscard]] bool overwrite() const { return overwrite_; }

 private:
  std::string json_;
  std::string plot_;
  bool overwrite_ = false;
};

}  // namespace headway::app
