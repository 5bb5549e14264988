// SPDX-License-Identifier: BSD-3-Clause
#include <headway/map/map_export.h>
#include <headway/map/map_files.h>
#include <headway/map/static_grid.h>

#include <utility>

namespace headway::map {

void writeMapFiles(const std::filesystem::path& folder, StoredMap stored) {
  if (const auto grid = stored.map.staticGrid()) writeStaticGrid(folder / "map_grid", *grid);
  writeSimpleMap(folder / "map.simplemap", *stored.map.staticMap());
  writePly(folder / "map_points.ply", *stored.map.staticMap());
  if (const auto& dense = stored.map.dense()) writePly(folder / "map_dense.ply", *dense);
  saveMap(folder / "map.headway", std::move(stored));
}

}  // namespace headway::map
