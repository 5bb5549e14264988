// SPDX-License-Identifier: BSD-3-Clause
// Formatted, printable and naturally sorted texts.
#include <headway/core/text.h>

#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>

namespace headway {

std::string formatted(const char* format, ...) {
  std::string text(256, '\0');
  while (true) {
    va_list arguments;
    va_start(arguments, format);
    const int length = std::vsnprintf(text.data(), text.size(), format, arguments);
    va_end(arguments);
    const bool is_whole = static_cast<std::size_t>(length) < text.size();
    text.resize(static_cast<std::size_t>(length) + (is_whole ? 0 : 1));
    if (is_whole) return text;
  }
}

namespace {

/// Number of bytes of the UTF-8 character at the start of a text; 0 if there is none.
/// RFC 3629, section 4: overlong forms, surrogates and values above U+10FFFF are not UTF-8.
std::size_t characterLength(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  if (length == 0 || first > 0xF4) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return 0;
  }
  const bool is_overlong = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xF0 && byte(1) < 0x90);
  const bool is_beyond = (first == 0xED && byte(1) >= 0xA0) || (first == 0xF4 && byte(1) >= 0x90);
  return is_overlong || is_beyond ? 0 : length;
}

bool isControl(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 1) return first < ' ' || first == 0x7F;
  return first == 0xC2 && static_cast<unsigned char>(character[1]) < 0xA0;  // U+0080 to U+009F
}

}  // namespace

std::string printable(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = characterLength(text);
    const std::string_view character = text.substr(0, length == 0 ? 1 : length);
    if (character[0] == '\n') {
      result += ' ';
    } else if (length == 0 || isControl(character)) {
      result += '?';
    } else {
      result += character;
    }
    text.remove_prefix(character.size());
  }
  return result;
}

}  // namespace headway
