// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/map/map_file.h>

#include <filesystem>
#include <string>

namespace headway::map {

/// Writes map.headway, and what other programs read of it: map.simplemap, map_points.ply and the
/// files of the grid, if there is one.
///
/// @throws InputError if a file cannot be written
void writeMapFiles(const std::filesystem::path& folder, StoredMap stored);

/// The same of the static layers alone, without map.headway and map.simplemap.
///
/// @param suffix  of the files' names: map_grid<suffix>, map_points<suffix>.ply, ...
void writeMapLayers(const std::filesystem::path& folder, const PerceptionMap& map,
                    const std::string& suffix = "");

}  // namespace headway::map
