#pragma once

#include <string>

namespace headway {

/// SHA-256 of a file, as 64 hexadecimal digits.
///
/// @throws InputError if the file cannot be read
/// @see  FIPS 180-4, "Secure Hash Standard"
[[nodiscard]] std::string sha256OfFile(const std::string& path);

}  // namespace headway
