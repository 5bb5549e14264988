#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/eval/grid_error.h>

#include <filesystem>
#include <vector>

namespace headway::app {

/// What stops a robot, by its height above the ground [m].
struct ObstacleHeights {
  double lowest = 0.3;
  double highest = 2.0;
};

/// What is true of the cells of a grid.
struct GridTruth {
  eval::GridCells cells;
  std::vector<std::uint8_t> trodden;  ///< 1: something moved over the cell at some time
};

/// Works the truth out from what headway-sim wrote beside a rawlog: true depth images, masks of
/// movers, true poses. A cell is occupied if a surface that stands at an obstacle's height was seen
/// in it, free if the ground was and no such surface.
///
/// @param folder  NAME.truth with depth/, masks/, trajectory.tum and objects.csv
/// @param camera  that the depth images are of, on the robot
/// @param grid    whose cells are meant
/// @throws InputError if something is missing, or of another size than the camera
[[nodiscard]] GridTruth gridTruth(const std::filesystem::path& folder, const StereoCamera& camera,
                                  const eval::GridCells& grid, const ObstacleHeights& heights);

}  // namespace headway::app
