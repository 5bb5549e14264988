// SPDX-License-Identifier: BSD-3-Clause
#include "ground_drawing.h"

#include <headway/core/parallel_rows.h>

#include <algorithm>
#include <cmath>

namespace headway::scene {
namespace {

// Cells that are shown, by their probability to be free, and their opacity.
constexpr float kFreeAbove = 0.6F;
constexpr float kOccupiedBelow = 0.4F;
constexpr std::uint8_t kFreeOpacity = 110, kOccupiedOpacity = 190;

void paintCell(float free, const Palette& palette, cv::Vec3b& colour, std::uint8_t& opacity) {
  const bool occupied = free < kOccupiedBelow;
  const Colour shown = occupied ? palette.occupied : palette.free;
  colour = {shown.blue, shown.green, shown.red};
  opacity = occupied ? kOccupiedOpacity : free > kFreeAbove ? kFreeOpacity : 0;
}

/// @param opacity  0 to 255
cv::Vec3b blended(const cv::Vec3b& below, const cv::Vec3b& above, int opacity) {
  cv::Vec3b result;
  for (int i = 0; i < 3; ++i) {
    result[i] = static_cast<std::uint8_t>((below[i] * (255 - opacity) + above[i] * opacity) / 255);
  }
  return result;
}

}  // namespace

OccupancyPicture occupancyAround(const mrpt::maps::COccupancyGridMap2D& grid,
                                 const Eigen::Vector3d& centre, double radius_m,
                                 const Palette& palette) {
  OccupancyPicture result;
  result.cell_m = static_cast<double>(grid.getResolution());
  const auto x_min = static_cast<double>(grid.getXMin());
  const auto y_min = static_cast<double>(grid.getYMin());
  const auto cell = [&](double metres, double edge) {
    return static_cast<int>(std::floor((metres - edge) / result.cell_m));
  };
  const int left = std::max(0, cell(centre.x() - radius_m, x_min));
  const int bottom = std::max(0, cell(centre.y() - radius_m, y_min));
  const int right =
      std::min(static_cast<int>(grid.getSizeX()), cell(centre.x() + radius_m, x_min) + 1);
  const int top =
      std::min(static_cast<int>(grid.getSizeY()), cell(centre.y() + radius_m, y_min) + 1);
  if (left >= right || bottom >= top) return result;
  result.x_min = x_min + result.cell_m * left;
  result.y_min = y_min + result.cell_m * bottom;
  result.colours.create(top - bottom, right - left, CV_8UC3);
  result.opacity.create(top - bottom, right - left, CV_8UC1);
  forEachRow(top - bottom, [&](int row) {
    auto* colour = result.colours.ptr<cv::Vec3b>(row);
    auto* opacity = result.opacity.ptr<std::uint8_t>(row);
    for (int x = left; x < right; ++x, ++colour, ++opacity) {
      paintCell(grid.getCell(x, bottom + row), palette, *colour, *opacity);
    }
  });
  return result;
}

void drawOccupancy(const OccupancyPicture& occupancy, double ground_z,
                   const render::PinholeView& view, cv::Mat& picture) {
  if (occupancy.colours.empty()) return;
  const Eigen::Vector3d viewpoint = view.T_map_camera.translation();
  const double drop = ground_z - viewpoint.z();
  const double x_origin = (viewpoint.x() - occupancy.x_min) / occupancy.cell_m;
  const double y_origin = (viewpoint.y() - occupancy.y_min) / occupancy.cell_m;
  const Eigen::Vector3d across = view.T_map_camera.linear().col(0) / view.fx;
  forEachRow(picture.rows, [&](int row) {
    const Eigen::Vector3d ray = view.T_map_camera.linear() *
                                Eigen::Vector3d(-view.cx / view.fx, (row - view.cy) / view.fy, 1.0);
    const double scale = drop / ray.z();  // of the whole row, without roll
    if (!(scale > 0.0 && scale < view.far_m)) return;
    const double cells = scale / occupancy.cell_m;
    const double x_left = x_origin + cells * ray.x(), x_step = cells * across.x();
    const double y_left = y_origin + cells * ray.y(), y_step = cells * across.y();
    auto* pixel = picture.ptr<cv::Vec3b>(row);
    for (int column = 0; column < picture.cols; ++column) {
      const double x = x_left + column * x_step, y = y_left + column * y_step;
      if (!(x >= 0.0 && y >= 0.0 && x < occupancy.colours.cols && y < occupancy.colours.rows)) {
        continue;
      }
      const int cell_x = static_cast<int>(x), cell_y = static_cast<int>(y);
      const int opacity = occupancy.opacity.ptr<std::uint8_t>(cell_y)[cell_x];
      if (opacity == 0) continue;
      pixel[column] =
          blended(pixel[column], occupancy.colours.ptr<cv::Vec3b>(cell_y)[cell_x], opacity);
    }
  });
}

void drawGridLines(Canvas& canvas, const render::PinholeView& view, const Eigen::Vector3d& centre,
                   double ground_z, double spacing_m) {
  const double extent = kGridExtentLines * spacing_m;
  const double x = spacing_m * std::round(centre.x() / spacing_m);
  const double y = spacing_m * std::round(centre.y() / spacing_m);
  const auto draw = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const auto segment = render::projectSegment(from, to, view);
    if (segment) canvas.line(segment->first, segment->second, 1.0, canvas.palette().grid);
  };
  const int lines = static_cast<int>(kGridExtentLines);
  for (int i = -lines; i <= lines; ++i) {
    const double offset = i * spacing_m;
    draw({x + offset, y - extent, ground_z}, {x + offset, y + extent, ground_z});
    draw({x - extent, y + offset, ground_z}, {x + extent, y + offset, ground_z});
  }
}

}  // namespace headway::scene
