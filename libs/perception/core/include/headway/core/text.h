// SPDX-License-Identifier: BSD-3-Clause
// Formatted, printable and naturally sorted texts.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace headway {

/// printf-style formatting, because streams depend on a locale. Texts of any length are whole.
[[nodiscard]] std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));

/// A text from a recording or a file name as one line for terminals and JSON: valid UTF-8 without
/// control characters, such as those of escape sequences. Line breaks become blanks, other control
/// characters and bytes that are not UTF-8 become question marks.
[[nodiscard]] std::string printable(std::string_view text);

[[nodiscard]] inline bool endsWith(std::string_view text, std::string_view ending) {
  return text.size() >= ending.size() && text.substr(text.size() - ending.size()) == ending;
}

namespace detail {

/// Takes the digits at the beginning of a text, without leading zeros.
inline std::string_view takeNumber(std::string_view& text) {
  constexpr std::string_view kDigits = "0123456789";
  const auto end = std::min(text.find_first_not_of(kDigits), text.size());
  std::string_view number = text.substr(0, end);
  text.remove_prefix(end);
  number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
  return number;
}

}  // namespace detail

/// Whether a file name comes before another, where numbers count by their value: left_9.png before
/// left_10.png. A strict weak order of all texts.
///
///     std::sort(paths.begin(), paths.end(), isNaturallyBefore);
[[nodiscard]] inline bool isNaturallyBefore(std::string_view a, std::string_view b) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const std::string_view whole_a = a, whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (is_digit(a.front()) && is_digit(b.front())) {
      const std::string_view first = detail::takeNumber(a), second = detail::takeNumber(b);
      if (first.size() != second.size()) return first.size() < second.size();
      if (first != second) return first < second;
    } else {
      if (a.front() != b.front()) return a.front() < b.front();
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.empty() && b.empty()) return whole_a < whole_b;  // equal but for leading zeros
  return a.empty();
}

}  // namespace headway
