// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/eval_files/grid_evaluation.h>

#include <filesystem>
#include <vector>

namespace headway::eval_files {

/// True state of the cells of a grid.
struct GridTruth {
  eval::GridCells cells;
  std::vector<std::uint8_t> swept;     ///< 1: a moving object covered the cell at some time
  std::vector<std::uint8_t> in_reach;  ///< 1: an obstacle in the cell was visible within the reach
  std::vector<std::uint8_t> ahead;     ///< 1: it was visible at a depth of 0.5 to 3 m
  std::vector<std::uint8_t> drops;     ///< 1: the floor is lower than the ground by min_m or
                                       ///< more, or the cell lies in an outline of drops.csv
};

/// Computes the true occupancy from the truth folder of a simulated rawlog: true depth images,
/// masks of moving objects and true poses. A cell is occupied if a static surface at an obstacle's
/// height is visible in it, free if only ground is, unknown if a surface within 1 cm of the minimum
/// height is and no higher one. An obstacle counts as visible where both cameras see it, with 49
/// pixels in one frame of the left one: a quarter of a block that is matched.
///
/// @param folder  NAME.truth with depth/, masks/, trajectory.tum, objects.csv and, if there are
///                drops, drops.csv
/// @param camera  camera of the depth images, mounted on the robot
/// @param grid    defines the cells; its states are not used
/// @throws InputError if a file is missing or its size differs from the camera's
[[nodiscard]] GridTruth gridTruth(const std::filesystem::path& folder, const StereoCamera& camera,
                                  const eval::GridCells& grid, const ObstacleHeights& heights,
                                  const ObstacleReach& reach);

}  // namespace headway::eval_files
