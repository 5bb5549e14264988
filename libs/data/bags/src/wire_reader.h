// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/bags/bag_reader.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "broken_data.h"

namespace headway::bags {

/// Reads the fields of a message in both of ROS' encodings, which differ in alignment, in the
/// terminating zero of strings, and in byte order.
///
/// Each length is checked against what is left before memory is allocated. Fast CDR and
/// roscpp_serialization resize to a length first.
class WireReader {
 public:
  /// @throws BrokenData if the encoding is not read
  WireReader(std::string_view message, Encoding encoding);

  [[nodiscard]] bool isRos1() const { return max_alignment_ == 1; }

  /// @throws BrokenData beyond the end, as all functions
  template <typename Number>
  Number number() {
    static_assert(std::is_arithmetic_v<Number>);
    align(sizeof(Number));
    std::array<char, sizeof(Number)> bytes;
    std::memcpy(bytes.data(), take(sizeof(Number)).data(), sizeof(Number));
    if (is_big_endian_) std::reverse(bytes.begin(), bytes.end());
    Number value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  std::string text();
  /// A sequence of bytes; valid as long as the message.
  std::string_view bytes() { return take(number<std::uint32_t>()); }
  /// The length of a sequence whose elements have at least `min_bytes`.
  std::uint32_t length(std::size_t min_bytes);

  template <typename Number>
  std::vector<Number> numbers() {
    std::vector<Number> values(length(sizeof(Number)));
    for (Number& value : values) value = number<Number>();
    return values;
  }
  template <typename Number, std::size_t kSize>
  std::array<Number, kSize> array() {
    std::array<Number, kSize> values;
    for (Number& value : values) value = number<Number>();
    return values;
  }

  /// @throws BrokenData if more is left than the padding of CDR: the message has another type
  void requireEnd() const;

 private:
  void align(std::size_t size);
  std::string_view take(std::size_t count);

  std::string_view bytes_;
  std::size_t at_ = 0;
  std::size_t max_alignment_ = 1;
  bool is_big_endian_ = false;
};

}  // namespace headway::bags
