// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/map/map_file.h>

#include <filesystem>

namespace headway::map {

/// Writes map.headway, and what other programs read of it: map.simplemap, map_points.ply and the
/// files of the grid, if there is one.
///
/// @throws InputError if a file cannot be written
void writeMapFiles(const std::filesystem::path& folder, StoredMap stored);

}  // namespace headway::map
