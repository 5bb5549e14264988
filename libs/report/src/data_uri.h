#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace headway::report {

/// Bytes in base 64 (RFC 4648), padded.
[[nodiscard]] std::string base64(const std::vector<std::uint8_t>& bytes);

/// A picture as a JPEG data URI, no wider than `most_width` [px].
///
/// @throws InputError if it cannot be read
[[nodiscard]] std::string pictureUri(const std::filesystem::path& path, int most_width);

}  // namespace headway::report
