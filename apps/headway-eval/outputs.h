#pragma once

#include <headway/program/command_line.h>

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>
#include <string>

namespace headway::app {

/// Where the figures go besides standard output: the options that all sub-commands share.
class Outputs {
 public:
  /// Adds --json, --plot and -w.
  void describe(program::CommandLine& line);

  /// @throws InputError if a file exists and may not be overwritten
  void requireWritable() const;

  /// Makes and writes what was asked for, and nothing else.
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
