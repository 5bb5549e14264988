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
  for (int y = bottom; y < top; ++y) {
    auto* colour = result.colours.ptr<cv::Vec3b>(y - bottom);
    auto* opacity = result.opacity.ptr<std::uint8_t>(y - bottom);
    for (int x = left; x < right; ++x, ++colour, ++opacity) {
      paintCell(grid.getCell(x, y), palette, *colour, *opacity);
    }
  }
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
    Eigen::Vector3d ray = view.T_map_camera.linear() *
                          Eigen::Vector3d(-view.cx / view.fx, (row - view.cy) / view.fy, 1.0);
    auto* pixel = picture.ptr<cv::Vec3b>(row);
    for (int column = 0; column < picture.cols; ++column, ++pixel, ray += across) {
      const double scale = drop / ray.z();
      if (!(scale > 0.0 && scale < view.far_m)) continue;
      const double x = x_origin + scale / occupancy.cell_m * ray.x();
      const double y = y_origin + scale / occupancy.cell_m * ray.y();
      if (!(x >= 0.0 && y >= 0.0 && x < occupancy.colours.cols && y < occupancy.colours.rows)) {
        continue;
      }
      const cv::Point cell(static_cast<int>(x), static_cast<int>(y));
      const int opacity = occupancy.opacity.at<std::uint8_t>(cell);
      if (opacity == 0) continue;
      const auto& colour = occupancy.colours.at<cv::Vec3b>(cell);
      for (int channel = 0; channel < 3; ++channel) {
        auto& value = (*pixel)[channel];
        value =
            static_cast<std::uint8_t>((value * (255 - opacity) + colour[channel] * opacity) / 255);
      }
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
