// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/formatted.h>

#include <cstdarg>
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

}  // namespace headway
