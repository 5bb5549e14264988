// SPDX-License-Identifier: BSD-3-Clause
// Reading a file of a bag within bounds: records, their values, and compressed chunks.
#pragma once

#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

namespace headway::bags {

/// A part of a recording that is not as its format says; it is skipped and counted.
class BrokenData : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads little-endian numbers and lengths of a record, each checked against what is left.
class ByteCursor {
 public:
  explicit ByteCursor(std::string_view bytes) : bytes_(bytes) {}

  [[nodiscard]] bool atEnd() const { return at_ == bytes_.size(); }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

  /// @throws BrokenData if fewer bytes are left, as all functions
  std::string_view bytes(std::uint64_t count) {
    if (count > left()) throw BrokenData("a length exceeds its record");
    const auto result = bytes_.substr(at_, static_cast<std::size_t>(count));
    at_ += static_cast<std::size_t>(count);
    return result;
  }
  template <typename Number>
  Number number() {
    static_assert(std::is_arithmetic_v<Number>);
    Number value;
    std::memcpy(&value, bytes(sizeof value).data(), sizeof value);
    return value;
  }
  /// Bytes after their number.
  template <typename Length = std::uint32_t>
  std::string_view block() {
    return bytes(number<Length>());
  }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

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

/// Decompresses a chunk of a bag.
///
/// Memory grows with the bytes that are decompressed, up to `size`.
///
/// @param compression  "none" or "", "lz4", "zstd", "bz2"
/// @param size         number of bytes that the chunk states
/// @param buffer       for the result, unless there is no compression
/// @return             the contents; valid as long as `bytes` and `buffer`
/// @throws BrokenData  if it is damaged, of another size, or larger than kMaxRecordBytes
/// @throws InputError  if this build does not have the compression, with the package to install
[[nodiscard]] std::string_view decompress(const std::string& compression, std::string_view bytes,
                                          std::uint64_t size, std::string& buffer);

}  // namespace headway::bags
