#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/eval/grid_error.h>

#include <filesystem>
#include <vector>

namespace headway::app {

/// Heights above the ground between which a surface is an obstacle [m].
struct ObstacleHeights {
  double min_m = 0.3;
  double max_m = 2.0;
};

/// True state of the cells of a grid.
struct GridTruth {
  eval::GridCells cells;
  std::vector<std::uint8_t> swept;  ///< 1: a moving object covered the cell at some time
};

/// Computes the true occupancy from the truth folder of a simulated rawlog: true depth images,
/// masks of moving objects and true poses. A cell is occupied if a static surface at an obstacle's
/// height is visible in it, free if only ground is.
///
/// @param folder  NAME.truth with depth/, masks/, trajectory.tum and objects.csv
/// @param camera  camera of the depth images, mounted on the robot
/// @param grid    defines the cells; its states are not used
/// @throws InputError if a file is missing or its size differs from the camera's
[[nodiscard]] GridTruth gridTruth(const std::filesystem::path& folder, const StereoCamera& camera,
                                  const eval::GridCells& grid, const ObstacleHeights& heights);

}  // namespace headway::app
