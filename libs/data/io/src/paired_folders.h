// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/io/dataset.h>

#include <filesystem>
#include <string>
#include <vector>

#include "image_files.h"

namespace headway::io {

/// Two folders with as many images each: the left ones, and the right or depth ones.
class PairedFolders : public Dataset {
 public:
  [[nodiscard]] std::size_t size() const override { return lefts_.size(); }

 protected:
  /// @throws InputError if the numbers of images differ, or there is none
  PairedFolders(const std::string& left_folder, const std::string& other_folder)
      : lefts_(imagesIn(left_folder)), others_(imagesIn(other_folder)) {
    requirePaired(left_folder, lefts_, other_folder, others_);
  }

  /// Takes the times of what a calibration, `file` read from `path`, says of them.
  template <typename CalibrationFile>
  void setTimes(const CalibrationFile& file, const std::string& path) {
    const auto folder = std::filesystem::path(path).parent_path();
    times_ = frameTimes(file.times, file.frame_rate, folder.string(), lefts_.size());
  }

  [[nodiscard]] const std::string& left(std::size_t index) const { return lefts_.at(index); }
  [[nodiscard]] const std::string& other(std::size_t index) const { return others_.at(index); }
  [[nodiscard]] Time time(std::size_t index) const { return times_.at(index); }

 private:
  std::vector<std::string> lefts_;
  std::vector<std::string> others_;
  std::vector<Time> times_;
};

}  // namespace headway::io
