// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/bags/bag_reader.h>

#include <string>

namespace headway::bags {

inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";

/// Opens an MCAP file (version 0) with chunks compressed by lz4 or Zstandard, or not at all.
///
/// @throws InputError if it has no readable record
[[nodiscard]] std::unique_ptr<BagReader> openMcapBag(const std::string& path);

}  // namespace headway::bags
