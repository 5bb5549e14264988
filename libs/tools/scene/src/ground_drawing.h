// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/render/pinhole_view.h>
#include <mrpt/maps/COccupancyGridMap2D.h>

#include <opencv2/core/mat.hpp>

#include "canvas.h"

namespace headway::scene {

/// Cells of the occupancy grid in a square around a place: BGR, and opacity; the first row is that
/// of the lowest y. Unknown cells have no opacity.
struct OccupancyPicture {
  cv::Mat colours;      ///< 8-bit BGR; empty without cells in the area
  cv::Mat opacity;      ///< 8-bit
  double x_min = 0.0;   ///< left edge [m, map frame]
  double y_min = 0.0;   ///< lower edge [m, map frame]
  double cell_m = 0.0;  ///< side of a cell [m]
};

[[nodiscard]] OccupancyPicture occupancyAround(const mrpt::maps::COccupancyGridMap2D& grid,
                                               const Eigen::Vector3d& centre, double radius_m,
                                               const Palette& palette);

/// Blends the cells on the ground over a picture.
///
/// @param view  without roll
void drawOccupancy(const OccupancyPicture& occupancy, double ground_z,
                   const render::PinholeView& view, cv::Mat& picture);

/// Draws the lines of the ground grid around a place.
void drawGridLines(Canvas& canvas, const render::PinholeView& view, const Eigen::Vector3d& centre,
                   double ground_z, double spacing_m);

/// Lines of the ground grid to each side of the robot.
inline constexpr double kGridExtentLines = 15.0;

}  // namespace headway::scene
