// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace headway {

/// A text from a recording or a file name as one line for terminals and JSON: valid UTF-8 without
/// control characters, such as those of escape sequences. Line breaks become blanks, other control
/// characters and bytes that are not UTF-8 become question marks.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace headway
