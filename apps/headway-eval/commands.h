// SPDX-License-Identifier: BSD-3-Clause
// The sub-commands of headway-eval, and the output files that they have in common.
#pragma once

#include <headway/program/command_line.h>

#include <functional>
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>
#include <string>

namespace headway::app {

/// Sub-commands of headway-eval; each parses its arguments and returns the exit status.
int runTrajectory(int argc, const char** argv);
int runTracks(int argc, const char** argv);
int runMovers(int argc, const char** argv);
int runPeople(int argc, const char** argv);
int runPredictions(int argc, const char** argv);
int runGrid(int argc, const char** argv);
int runDense(int argc, const char** argv);
int runSuite(int argc, const char** argv);

/// Name of a result in titles, with the folder of its recording: "street/trajectory.tum".
[[nodiscard]] std::string recordingName(const std::string& path);

/// Options for output files, common to all sub-commands.
class Outputs {
 public:
  /// Adds --json, --plot and -w to a command line, and reads it.
  ///
  /// @param inputs  targets of the options for files that are read
  /// @return false if the program has nothing more to do
  /// @throws InputError if a file exists and -w is not given, or is an input
  [[nodiscard]] bool parse(program::CommandLine& line, int argc, const char** argv,
                           std::initializer_list<const std::string*> inputs);

  /// Computes and writes only the requested files.
  ///
  /// @throws InputError if a file cannot be written
  void write(const std::function<nlohmann::ordered_json()>& figures,
             const std::function<cv::Mat()>& plot) const;

  [[nodiscard]] bool overwrite() const { return overwrite_; }
  [[nodiscard]] bool quiet() const { return quiet_; }

 private:
  std::string json_;
  std::string plot_;
  bool overwrite_ = false;
  bool quiet_ = false;
};

}  // namespace headway::app
