// SPDX-License-Identifier: BSD-3-Clause
// Writing of messages as ROS 2 sends them: plain CDR, little-endian.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace headway::ros2 {

/// Appends the fields of a message in the order of its definition, each aligned to its size.
class CdrWriter {
 public:
  CdrWriter() = default;

  template <typename Number>
  void number(Number value) {
    static_assert(std::is_arithmetic_v<Number> && !std::is_same_v<Number, bool>);
    while ((bytes_.size() - encapsulation_.size()) % sizeof value != 0) bytes_ += '\0';
    append(&value, sizeof value);
  }
  void flag(bool value) { bytes_ += static_cast<char>(value); }
  void text(std::string_view value) {
    length(value.size() + 1);
    bytes_.append(value);
    bytes_ += '\0';
  }
  /// Before the elements of a sequence.
  void length(std::size_t count) { number(static_cast<std::uint32_t>(count)); }
  /// Elements without padding, such as those of a sequence of octets or floats.
  void append(const void* data, std::size_t size) {
    bytes_.append(static_cast<const char*>(data), size);
  }
  void reserve(std::size_t size) { bytes_.reserve(bytes_.size() + size); }

  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  const std::string encapsulation_{'\0', '\1', '\0', '\0'};  ///< does not count for alignment
  std::string bytes_ = encapsulation_;
};

}  // namespace headway::ros2
