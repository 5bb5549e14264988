// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace headway::detect {

/// SHA-256 of a file, as 64 hexadecimal digits.
///
/// @throws InputError if the file cannot be read
[[nodiscard]] std::string sha256OfFile(const std::string& path);

}  // namespace headway::detect
