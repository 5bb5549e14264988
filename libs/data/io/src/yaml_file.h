// SPDX-License-Identifier: BSD-3-Clause
// Numbers and strings of YAML files.
#pragma once

#include <headway/core/pose.h>
#include <mrpt/containers/yaml.h>

#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace headway::io {

inline constexpr std::size_t kMaxCalibrationBytes = 1 << 20;  ///< of a file that is read

/// Reads numbers and strings of a YAML file, with messages that name file and key.
class YamlFile {
 public:
  /// @throws InputError if the file cannot be read or is not a YAML map
  explicit YamlFile(const std::string& path);

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Of the keys in messages: "cam0." below the key cam0.
  [[nodiscard]] const std::string& prefix() const { return prefix_; }
  [[nodiscard]] bool has(const std::string& key) const { return root_.has(key); }
  /// The map below a key; messages name both keys. @throws InputError if there is none
  [[nodiscard]] YamlFile within(const std::string& key) const;
  /// A list of numbers, also by rows or below `key`'s own key "data", or one number.
  ///
  /// @param min_size, max_size  allowed length of the list
  /// @throws InputError if the key is missing, or is not such a list
  [[nodiscard]] std::vector<double> numbers(const std::string& key, std::size_t min_size,
                                            std::size_t max_size) const;
  [[nodiscard]] double number(const std::string& key) const { return numbers(key, 1, 1).front(); }
  /// Width and height of images [px].
  ///
  /// @throws InputError if they are not whole, positive and below the limits of images
  [[nodiscard]] cv::Size imageSize(const std::string& key) const;
  [[nodiscard]] std::string word(const std::string& key) const;
  /// A pose as 12 (3x4) or 16 (4x4) numbers, row-major; also below `key`'s own key "data".
  [[nodiscard]] Pose pose(const std::string& key) const;
  /// @throws InputError naming the first key that is not in `known`
  void requireOnly(const std::vector<std::string>& known) const;
  /// @throws InputError "file: reason"
  [[noreturn]] void fail(const std::string& reason) const;

 private:
  YamlFile(std::string path, std::string prefix, mrpt::containers::yaml root)
      : path_(std::move(path)), prefix_(std::move(prefix)), root_(std::move(root)) {}

  std::string path_;
  std::string prefix_;  ///< of keys in messages
  mrpt::containers::yaml root_;
};

}  // namespace headway::io
