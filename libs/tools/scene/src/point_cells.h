// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/render/painter.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace headway::scene {

/// Points of a map in cells, so that a picture paints the visible cells only, near ones first, and
/// no more points of a cell than close its surfaces in the picture.
class PointCells {
 public:
  PointCells() = default;
  /// @param cell_m  side of a cell, above 0 [m]
  PointCells(std::vector<render::PaintedPoint> points, double cell_m);

  /// Paints the points that may be visible: all if they have no width in the world, and else an
  /// even sample of cells whose points cover each other several times.
  void paint(const render::PinholeView& view, const render::PointStyle& style,
             render::Painter& painter) const;

  /// Width of the discs that close the surfaces on which the points lie [m]: the median distance
  /// to the nearest neighbour, enlarged. 0 with fewer than two points.
  [[nodiscard]] double closingWidth() const;

  [[nodiscard]] bool empty() const { return cells_.empty(); }

 private:
  struct Cell {
    Eigen::AlignedBox3f bounds;
    std::size_t first = 0, count = 0;  ///< in points_; the first ones are a sample of all
  };
  [[nodiscard]] render::PointRun pointsOf(const Cell& cell) const {
    return {points_.data() + cell.first, cell.count};
  }
  [[nodiscard]] std::vector<std::uint32_t> sortIntoCells(double cell_m);

  std::vector<Cell> cells_;
  std::vector<render::PaintedPoint> points_;  ///< cell by cell
};

}  // namespace headway::scene
