// SPDX-License-Identifier: BSD-3-Clause
#include <headway/map/map_export.h>
#include <headway/map/map_files.h>
#include <headway/map/static_grid.h>

#include <utility>

namespace headway::map {

void writeMapLayers(const std::filesystem::path& folder, const PerceptionMap& map,
                    const std::string& suffix) {
  if (const auto grid = map.staticGrid()) writeStaticGrid(folder / ("map_grid" + suffix), *grid);
  writePly(folder / ("map_points" + suffix + ".ply"), *map.staticMap());
  if (const auto& dense = map.dense()) writePly(folder / ("map_dense" + suffix + ".ply"), *dense);
}

void writeMapFiles(const std::filesystem::path& folder, StoredMap stored) {
  writeMapLayers(folder, stored.map);
  writeSimpleMap(folder / "map.simplemap", *stored.map.staticMap());
  saveMap(folder / "map.headway", std::move(stored));
}

}  // namespace headway::map
