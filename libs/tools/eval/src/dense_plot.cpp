// SPDX-License-Identifier: BSD-3-Clause
#include <headway/eval/grid_error.h>
#include <headway/eval/plots.h>

#include <array>

#include "cell_picture.h"

namespace headway::eval {
namespace {

constexpr double kCell_m = 0.2;
constexpr double kMargin_m = 1.0;

/// What lies in the column above a cell.
struct Column {
  std::size_t covered = 0;
  std::size_t surface = 0;
  bool has_mover = false;
};

const std::vector<Shade>& coverageShades() {
  static const std::vector<Shade> kShades = {
      {"at least 80 % of the surface covered", {110, 150, 60}},
      {"50 to 80 %", {130, 215, 190}},
      {"20 to 50 %", {110, 190, 250}},
      {"less", {40, 90, 230}},
      {"points where only moving objects were", {200, 0, 200}},
      {"no surface within reach", {238, 238, 238}}};
  return kShades;
}

cv::Vec3b shadeOf(const Column& column) {
  if (column.has_mover) return coverageShades()[4].bgr;
  if (column.surface == 0) return coverageShades()[5].bgr;
  const double ratio = static_cast<double>(column.covered) / static_cast<double>(column.surface);
  const std::array<double, 3> limits = {0.8, 0.5, 0.2};
  std::size_t shade = 0;
  while (shade < limits.size() && ratio < limits[shade]) ++shade;
  return coverageShades()[shade].bgr;
}

/// Cells around all surface within reach; their states are not used.
GridCells cellsAround(const std::vector<TrueSurface::Patch>& patches, const DenseError& error) {
  Eigen::AlignedBox2d area(Eigen::Vector2d::Zero());
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (error.is_covered[i] != 2) area.extend(Eigen::Vector2d(patches[i].centre.head<2>()));
  }
  const Eigen::Vector2d corner = area.min().array() - kMargin_m;
  const Eigen::Vector2d size = (area.max() - corner).array() + kMargin_m;
  return {corner, kCell_m, static_cast<int>(size.x() / kCell_m) + 1,
          static_cast<int>(size.y() / kCell_m) + 1};
}

}  // namespace

cv::Mat densePlot(const std::vector<TrueSurface::Patch>& patches,
                  const std::vector<Eigen::Vector3d>& points, const DenseError& error) {
  const GridCells grid = cellsAround(patches, error);
  std::vector<Column> columns(grid.states.size());
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (error.is_covered[i] == 2) continue;
    const auto cell = grid.at(patches[i].centre.head<2>());
    if (!cell) continue;
    ++columns[*cell].surface;
    columns[*cell].covered += error.is_covered[i];
  }
  for (const auto point : error.mover_points) {
    if (const auto cell = grid.at(points[point].head<2>())) columns[*cell].has_mover = true;
  }
  cv::Mat cells(grid.rows, grid.columns, CV_8UC3);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      cells.at<cv::Vec3b>(grid.rows - 1 - row, column) =
          shadeOf(columns[static_cast<std::size_t>(row * grid.columns + column)]);
    }
  }
  return cellPicture(cells, grid.resolution_m, coverageShades());
}

}  // namespace headway::eval
