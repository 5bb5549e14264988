// SPDX-License-Identifier: BSD-3-Clause
// The container of map files: named sections, compressed, with checksums, replaced as a whole.
#pragma once

#include <headway/core/byte_archive.h>

#include <cstdint>
#include <string>
#include <vector>

namespace headway::map {

/// A named section of a checked file.
struct Section {
  std::string name;
  std::uint32_t version = 1;  ///< of the contents
  std::string bytes;
};

/// A section to be written.
struct SectionSource {
  std::string name;
  std::uint32_t version = 1;
  ByteSource bytes;  ///< called twice: for their number, then for themselves
};

/// Writes sections to a compressed file with checksums, atomically: to a temporary file, which is
/// then renamed.
///
/// Layout, little-endian: 8 bytes magic, u32 format version, u64 compressed size, u64 plain size,
/// u32 CRC-32 of the compressed bytes, u32 CRC-32 of all the above; then the zlib-compressed
/// sections, each u32 + name, u32 version, u64 + bytes.
///
/// @throws InputError if it cannot be written
void writeCheckedFile(const std::string& path, const std::vector<SectionSource>& sections);

/// The same for sections in memory.
void writeCheckedFile(const std::string& path, const std::vector<Section>& sections);

/// Reads a file of writeCheckedFile().
///
/// @throws InputError (without the path) stating whether it is missing, not a map, truncated,
///         damaged or of another format version
[[nodiscard]] std::vector<Section> readCheckedFile(const std::string& path);

}  // namespace headway::map
