// SPDX-License-Identifier: BSD-3-Clause
#include "map_picture.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "canvas.h"
#include "ground_drawing.h"
#include "map_points.h"
#include "view.h"
#include "world_scene.h"

namespace headway::scene {
namespace {

constexpr double kCellM = 4.0;              // of points
constexpr double kOccupancyRadiusM = 60.0;  // around the robot, at scale 1
constexpr double kMarginM = 0.5;            // of hidden objects, at scale 1
constexpr double kMaxWidthM = 0.5;          // of the dense map's discs
constexpr double kMaxWidthPoints = 24.0;    // of the same in the picture [points]
constexpr double kDotsOnDense = 0.65;       // width of dots on the dense map to those alone
constexpr double kClearRatio = 0.45;        // of the way to the robot that is kept free of points

}  // namespace

MapPicture::MapPicture(const SnapshotOptions& options)
    : options_(options),
      palette_(paletteOf(options.theme)),
      painter_(options.width * options.supersampling, options.height * options.supersampling) {}

void MapPicture::updateLandmarks(const SnapshotInput& input, double ground_z) {
  if (static_map_ == input.map.staticMap()) return;
  static_map_ = input.map.staticMap();
  landmarks_ =
      PointCells(landmarkPoints(*static_map_, ground_z, sceneScale(input), palette_), kCellM);
}

void MapPicture::updateDense(const SnapshotInput& input) {
  const auto dense = options_.dense ? input.map.dense() : nullptr;
  if (dense_map_ == dense) return;
  dense_map_ = dense;
  dense_ = dense == nullptr ? PointCells() : PointCells(densePoints(*dense, palette_), kCellM);
  dense_width_m_ = std::min(kMaxWidthM, dense_.closingWidth());
}

cv::Mat MapPicture::draw(const SnapshotInput& input, const render::PinholeView& view,
                         double ground_z) {
  updateLandmarks(input, ground_z);
  updateDense(input);
  const auto drawn = render::enlarged(view, options_.supersampling);
  margin_m_ = kMarginM * sceneScale(input);
  painter_.clear(drawn, palette_.backdrop);
  paintGround(input, drawn, ground_z);
  paintPoints(input, drawn);
  painter_.shade();
  painter_.paint(pictureTriangles(input, palette_, ground_z), margin_m_);
  if (options_.supersampling == 1) return painter_.picture().clone();
  cv::Mat picture;
  cv::resize(painter_.picture(), picture, {view.width, view.height}, 0.0, 0.0, cv::INTER_AREA);
  return picture;
}

void MapPicture::paintGround(const SnapshotInput& input, const render::PinholeView& view,
                             double ground_z) {
  const Eigen::Vector3d robot = input.T_map_robot.translation();
  const double scale = sceneScale(input);
  if (const auto grid = input.map.staticGrid()) {
    const double radius = kOccupancyRadiusM * std::max(0.5, scale);
    drawOccupancy(occupancyAround(*grid, robot, radius, palette_), ground_z, view,
                  painter_.picture());
  }
  Canvas canvas(painter_.picture(), palette_);
  drawGridLines(canvas, view, robot, ground_z, gridSpacing(scale));
}

void MapPicture::paintPoints(const SnapshotInput& input, const render::PinholeView& view) {
  const auto pixels = [&](double value) {
    return static_cast<float>(value * options_.supersampling);
  };
  const cv::Size size(options_.width, options_.height);
  const double distance =
      (view.T_map_camera.translation() - input.T_map_robot.translation()).norm();
  render::PointStyle surface;
  surface.width_m = static_cast<float>(dense_width_m_);
  surface.min_px = 2.F;
  surface.max_px = pixels(kMaxWidthPoints * std::max(1.0, pixelsPerPoint(size)));
  surface.near_m = static_cast<float>(kClearRatio * distance);
  dense_.paint(view, surface, painter_);
  render::PointStyle dot;
  dot.min_px = dot.max_px = pixels(landmarkWidth(size) * (dense_.empty() ? 1.0 : kDotsOnDense));
  dot.nearer_m = static_cast<float>(2.0 * dense_width_m_);
  landmarks_.paint(view, dot, painter_);
}

}  // namespace headway::scene
