// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace headway::bags {

/// Decompresses a chunk of a bag.
///
/// Memory grows with the bytes that are decompressed, up to `size`.
///
/// @param compression  "none" or "", "lz4", "zstd", "bz2"
/// @param size         number of bytes that the chunk states
/// @param buffer       for the result, unless there is no compression
/// @return             the contents; valid as long as `bytes` and `buffer`
/// @throws BrokenData  if it is damaged, of another size, or larger than kMaxRecordBytes
/// @throws InputError  if this build does not have the compression, with the package to install
[[nodiscard]] std::string_view decompress(const std::string& compression, std::string_view bytes,
                                          std::uint64_t size, std::string& buffer);

}  // namespace headway::bags
