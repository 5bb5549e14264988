// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "broken_data.h"

namespace headway::bags {

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

}  // namespace headway::bags
