#pragma once

#include <headway/core/params.h>
#include <headway/core/stereo_camera.h>
#include <headway/slam/map_view.h>
#include <mrpt/maps/COccupancyGridMap2D.h>

#include <optional>
#include <string>

namespace headway::map {

/// How the still world becomes a grid of free and occupied cells.
struct StaticGridParams {
  double resolution_m = 0.2;  ///< [m] 0.05 ... 2
  double reach_m = 20.0;      ///< [m] 2 ... 100: landmarks farther from a keyframe are not used
  double lowest_obstacle_m = 0.3;   ///< [m] 0.05 ... 2: what is lower is ground
  double highest_obstacle_m = 2.0;  ///< [m] 0.3 ... 10: what is higher does not stop the robot
  int min_observations = 3;         ///< [keyframes] 1 ... 20: landmarks seen in fewer are not used

  void describe(Params::Section section);
};

/// Where one can drive: the sight lines from every keyframe to the landmarks that it sees.
///
/// A landmark of an obstacle's height occupies its cell and frees those before it; one on the
/// ground frees the last part of the way to it, where the sight line is lower than an obstacle;
/// and the robot's own way is free.
/// Landmarks come from stereo and exclude what moves, so movers leave nothing behind; the grid is
/// made from the map as it is now, so it follows every correction of the map. Heights are seen
/// from the robot, so the ground may slope. Cells that no sight line crosses stay at 0.5. A map
/// larger than 25 million cells gets a coarser grid.
///
/// Costs about 10 ms for 120 keyframes of a street.
///
/// @return null where there is no keyframe, or the ground cannot be told (see groundInRobot)
[[nodiscard]] mrpt::maps::COccupancyGridMap2D::Ptr buildStaticGrid(const slam::MapView& still_world,
                                                                   const StereoCamera& camera,
                                                                   const StaticGridParams& params);

/// Height of the ground in the robot's frame [m].
///
/// Zero where the camera stands well above the robot's origin. A robot frame that stands in the
/// camera says nothing; then it is the height at which most landmarks near and below the camera
/// lie.
///
/// @return nullopt if too few landmarks (30) lie below the camera
[[nodiscard]] std::optional<double> groundInRobot(const slam::MapView& still_world,
                                                  const StereoCamera& camera);

/// Writes `<prefix>.gridmap.gz` (MRPT), and `<prefix>.png` with `<prefix>.yaml` (map servers).
///
/// @throws InputError if a file cannot be written
void writeStaticGrid(const std::string& prefix, const mrpt::maps::COccupancyGridMap2D& grid);

}  // namespace headway::map
