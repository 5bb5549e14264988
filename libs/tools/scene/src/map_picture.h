// SPDX-License-Identifier: BSD-3-Clause
// The picture of a map: points, paths and moving objects without text.
#pragma once

#include <headway/render/painter.h>
#include <headway/scene/snapshot.h>
#include <headway/slam/map_view.h>
#include <mrpt/maps/CColouredPointsMap.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <opencv2/core/types.hpp>
#include <vector>

#include "canvas.h"

namespace headway::scene {

/// Landmarks in their image intensity, tinted by their height above the ground.
///
/// @param scale  see sceneScale()
[[nodiscard]] std::vector<render::PaintedPoint> landmarkPoints(const slam::MapView& static_map,
                                                               double ground_z, double scale,
                                                               const Palette& palette);

/// The dense map in its colours, less saturated, so that tracks stand out.
[[nodiscard]] std::vector<render::PaintedPoint> densePoints(
    const mrpt::maps::CColouredPointsMap& dense, const Palette& palette);

/// Width of a landmark's dot: 2.6 points, and no less in pixels, so that it can be seen [px].
[[nodiscard]] double landmarkWidth(const cv::Size& picture);

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

/// Draws the map without outlines and text: sky and ground, occupancy, grid, points, paths, robot
/// and the moving objects' faces, trails and predictions. Points are prepared when they change.
class MapPicture {
 public:
  explicit MapPicture(const SnapshotOptions& options);

  /// @param view      external view of the options' size
  /// @param ground_z  height of the ground [m, map frame]
  [[nodiscard]] cv::Mat draw(const SnapshotInput& input, const render::PinholeView& view,
                             double ground_z);

  /// Whether points of the last picture hide a place of the map.
  [[nodiscard]] bool hides(const Eigen::Vector3d& place_map) const {
    return painter_.hides(place_map, margin_m_);
  }

 private:
  void updateLandmarks(const SnapshotInput& input, double ground_z);
  void updateDense(const SnapshotInput& input);
  void paintGround(const SnapshotInput& input, const render::PinholeView& view, double ground_z);
  void paintPoints(const SnapshotInput& input, const render::PinholeView& view);

  SnapshotOptions options_;
  const Palette& palette_;
  render::Painter painter_;
  double margin_m_ = 0.0;  ///< by which points must be nearer to hide something
  std::shared_ptr<const slam::MapView> static_map_;  ///< of landmarks_
  PointCells landmarks_;
  mrpt::maps::CColouredPointsMap::ConstPtr dense_map_;  ///< of dense_
  PointCells dense_;
  double dense_width_m_ = 0.0;
};

}  // namespace headway::scene
