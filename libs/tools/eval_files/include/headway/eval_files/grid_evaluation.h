// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/eval/grid_error.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace headway::eval_files {

/// Heights above the ground between which a surface is an obstacle [m].
struct ObstacleHeights {
  double min_m = 0.3;
  double max_m = 2.0;
};

/// Depths between which the rig claims to see obstacles [m].
struct ObstacleReach {
  double from_m = 0.0;
  double to_m = 40.0;
};

/// Errors of a replay's occupancy grid, with the cells that were compared.
struct GridEvaluation {
  eval::GridCells estimate;
  eval::GridCells truth;
  std::vector<std::uint8_t> swept;  ///< 1: a moving object covered the cell at some time
  ObstacleHeights heights;
  ObstacleReach reach;  ///< that the replay claims
  eval::GridError error;
  eval::VisibleObstacles in_reach;  ///< obstacles that were visible within the reach
  eval::VisibleObstacles ahead;     ///< and those that were visible at 0.5 to 3 m
  std::size_t drops = 0;            ///< cells lower than the ground
  std::size_t drops_free = 0;       ///< of these, estimated as free
};

/// Evaluates a replay as `headway-eval grid` does.
///
/// @param truth    folder written by headway-sim --depth --masks
/// @param replay   with map_grid.gridmap.gz and calibration.yaml
/// @param heights  of obstacles; 0: as in the replay
/// @throws InputError if a file is missing or its size differs from the camera's
[[nodiscard]] GridEvaluation evaluateGrid(const std::filesystem::path& truth,
                                          const std::filesystem::path& replay,
                                          const ObstacleHeights& heights);

/// The figures of `headway-eval grid --json`.
[[nodiscard]] nlohmann::ordered_json toJson(const GridEvaluation& evaluation);

}  // namespace headway::eval_files
