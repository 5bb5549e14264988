#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace headway::map {

/// A named piece of a checked file.
struct Section {
  std::string name;
  std::uint32_t version = 1;  ///< of the contents
  std::string bytes;
};

/// Writes sections to a file that is compressed and checksummed, in one step: beside its final
/// name first, then renamed.
///
/// Layout, little-endian: 8 bytes magic, u32 format version, u64 compressed size, u64 plain size,
/// u32 CRC-32 of the compressed bytes, u32 CRC-32 of all the above; then the zlib-compressed
/// sections, each u32 + name, u32 version, u64 + bytes.
///
/// @throws InputError if it cannot be written
void writeCheckedFile(const std::string& path, const std::vector<Section>& sections);

/// Reads what writeCheckedFile wrote.
///
/// @throws InputError (without the path) saying whether it is missing, foreign, truncated, damaged
///         or of a newer format
[[nodiscard]] std::vector<Section> readCheckedFile(const std::string& path);

}  // namespace headway::map
