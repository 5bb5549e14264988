// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

namespace headway::bags {

/// Largest record that is read into memory; raw images of 4096 x 4096 pixels have 50 MB.
inline constexpr std::uint64_t kMaxRecordBytes = 1 << 27;

/// Bytes of a file at any position.
class BagFile {
 public:
  /// @throws InputError if it is not a regular file that can be read
  explicit BagFile(const std::string& path);

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] std::uint64_t position() const { return position_; }
  [[nodiscard]] std::uint64_t left() const { return size_ - position_; }
  /// Beyond the end: to the end.
  void goTo(std::uint64_t position);

  /// The next bytes; empty if fewer are left, or more than kMaxRecordBytes are asked for. Valid
  /// until the next call.
  [[nodiscard]] std::string_view read(std::uint64_t count);

 private:
  std::string path_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;
  std::string buffer_;
};

}  // namespace headway::bags
