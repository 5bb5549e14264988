// SPDX-License-Identifier: BSD-3-Clause
// The picture of a map: points, paths and moving objects without text.
#include "map_picture.h"

#include <headway/core/parallel_rows.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <random>
#include <unordered_map>
#include <utility>

#include "canvas.h"
#include "view.h"
#include "world_scene.h"

namespace headway::scene {
namespace {

/// Image intensity, brightened and tinted by height.
Colour colourOf(const slam::LandmarkView& landmark, double ground_z, double scale,
                const Palette& palette) {
  const double brightness = 0.55 + 0.45 * landmark.intensity / 255.0;
  const double height =
      std::clamp((landmark.position.z() - ground_z) / (6.0 * std::max(0.4, scale)), 0.0, 1.0);
  const auto mix = [&](std::uint8_t low, std::uint8_t high) {
    return static_cast<std::uint8_t>(brightness * (low + height * (high - low)));
  };
  return {mix(palette.low.red, palette.high.red), mix(palette.low.green, palette.high.green),
          mix(palette.low.blue, palette.high.blue)};
}

}  // namespace

std::vector<render::PaintedPoint> landmarkPoints(const slam::MapView& static_map, double ground_z,
                                                 double scale, const Palette& palette) {
  std::vector<render::PaintedPoint> points;
  points.reserve(static_map.landmarks.size());
  for (const auto& landmark : static_map.landmarks) {
    points.push_back(
        {landmark.position.cast<float>(), colourOf(landmark, ground_z, scale, palette)});
  }
  return points;
}

std::vector<render::PaintedPoint> densePoints(const mrpt::maps::CColouredPointsMap& dense,
                                              const Palette& palette) {
  const auto saturation = static_cast<float>(palette.map_saturation);
  const auto black = static_cast<float>(255.0 * palette.map_black);
  const auto range = static_cast<float>(255.0 * (palette.map_white - palette.map_black));
  std::vector<render::PaintedPoint> points(dense.size());
  forEachRow(static_cast<int>(points.size()), [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    auto& position = points[i].position;
    dense.getPointFast(i, position.x(), position.y(), position.z());
    float red = 0.F, green = 0.F, blue = 0.F;
    dense.getPointColor_fast(i, red, green, blue);
    const float grey = 0.299F * red + 0.587F * green + 0.114F * blue;
    const auto toned = [&](float value) {
      return static_cast<std::uint8_t>(
          std::clamp(black + range * (grey + saturation * (value - grey)), 0.F, 255.F));
    };
    points[i].colour = {toned(red), toned(green), toned(blue)};
  });
  return points;
}

double landmarkWidth(const cv::Size& picture) {
  return 2.6 * std::max(1.0, pixelsPerPoint(picture));
}

namespace {

/// Whether the bounding sphere of the box intersects the viewing frustum.
///
/// @param centre  of the box, in the camera's frame [m]
bool mayBeVisible(const Eigen::Vector3d& centre, double radius, const render::PinholeView& view) {
  if (centre.z() < view.near_m - radius || centre.z() > view.far_m + radius) return false;
  const double tan_x = 0.5 * view.width / view.fx;
  const double tan_y = 0.5 * view.height / view.fy;
  return std::abs(centre.x()) <= centre.z() * tan_x + radius * std::sqrt(1.0 + tan_x * tan_x) &&
         std::abs(centre.y()) <= centre.z() * tan_y + radius * std::sqrt(1.0 + tan_y * tan_y);
}

/// What of a cell is painted, and where.
///
/// A cell whose corners are all before the camera takes as many points at random as close its
/// projection, if they have a width in the world; others take all points, in any row.
render::PointRun runOf(const Eigen::AlignedBox3f& bounds, render::PointRun run,
                       const render::PointStyle& style, const render::PinholeView& view) {
  Eigen::AlignedBox2d covered;
  double farthest = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d place =
        bounds.corner(static_cast<Eigen::AlignedBox3f::CornerType>(corner)).cast<double>();
    const auto pixel = render::project(place, view);
    if (!pixel) return run;
    covered.extend(*pixel);
    farthest = std::max(farthest, (place - view.T_map_camera.translation()).norm());
  }
  const double margin = 0.5 * static_cast<double>(style.max_px) + 1.0;
  const auto row = [&](double v) {
    return static_cast<int>(std::clamp(v, -1.0, static_cast<double>(view.height)));
  };
  run.top = row(covered.min().y() - margin);
  run.bottom = row(covered.max().y() + margin);
  if (!(style.width_m > 0.F)) return run;
  const double width_px = std::max(static_cast<double>(style.min_px),
                                   static_cast<double>(style.width_m) * view.fx / farthest);
  // So many points at random cover each pixel 1.3 times.
  const double enough =
      1.3 * (covered.sizes() + Eigen::Vector2d::Ones() * width_px).prod() / (width_px * width_px);
  if (enough < static_cast<double>(run.count)) run.count = static_cast<std::size_t>(enough);
  return run;
}

/// The cell of a place, by its coordinates in cells, which repeat after two million cells.
std::int64_t keyOf(const Eigen::Vector3f& place) {
  constexpr std::int64_t kCellsOfAxis = 1 << 21;
  const auto index = [](float value) {
    return static_cast<std::int64_t>(std::floor(value)) & (kCellsOfAxis - 1);
  };
  return (index(place.x()) * kCellsOfAxis + index(place.y())) * kCellsOfAxis + index(place.z());
}

/// Puts points in a random order that is the same each time.
void shuffle(render::PaintedPoint* points, std::size_t count) {
  std::mt19937 random(1);
  for (std::size_t i = count; i > 1; --i) std::swap(points[i - 1], points[random() % i]);
}

float nearestNeighbour(const render::PointRun& run, std::size_t index) {
  float nearest = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < run.count; ++i) {
    if (i == index) continue;
    nearest =
        std::min(nearest, (run.points[i].position - run.points[index].position).squaredNorm());
  }
  return std::sqrt(nearest);
}

}  // namespace

PointCells::PointCells(std::vector<render::PaintedPoint> points, double cell_m)
    : points_(std::move(points)) {
  std::vector<std::uint32_t> places = sortIntoCells(cell_m);
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    while (places[i] != i) {  // in place: a million points take 17 MB
      const std::uint32_t place = places[i];
      std::swap(points_[i], points_[place]);
      std::swap(places[i], places[place]);
    }
  }
  forEachRow(static_cast<int>(cells_.size()), [&](int i) {
    const Cell& cell = cells_[static_cast<std::size_t>(i)];
    shuffle(points_.data() + cell.first, cell.count);
  });
}

/// Makes the cells of the points, in the order of their first points.
///
/// @return  the place of each point if points are ordered by cells
std::vector<std::uint32_t> PointCells::sortIntoCells(double cell_m) {
  std::unordered_map<std::int64_t, std::uint32_t> cell_of_key;
  std::vector<std::uint32_t> places;  // first the cells
  places.reserve(points_.size());
  const auto side = static_cast<float>(cell_m);
  for (const auto& point : points_) {
    const auto cell = cell_of_key.try_emplace(keyOf(point.position / side), cells_.size()).first;
    places.push_back(cell->second);
    if (cell->second == cells_.size()) cells_.emplace_back();
    cells_[cell->second].bounds.extend(point.position);
    ++cells_[cell->second].count;
  }
  std::vector<std::uint32_t> next;
  for (auto& cell : cells_) {
    cell.first = next.empty() ? 0 : next.back() + cells_[next.size() - 1].count;
    next.push_back(static_cast<std::uint32_t>(cell.first));
  }
  for (auto& place : places) place = next[place]++;
  return places;
}

void PointCells::paint(const render::PinholeView& view, const render::PointStyle& style,
                       render::Painter& painter) const {
  const Pose T_camera_map = view.T_map_camera.inverse();
  std::vector<std::pair<double, const Cell*>> visible;  // by distance
  for (const auto& cell : cells_) {
    const Eigen::Vector3d centre = T_camera_map * cell.bounds.center().cast<double>();
    const double radius = 0.5 * static_cast<double>(cell.bounds.diagonal().norm());
    if (mayBeVisible(centre, radius, view)) visible.emplace_back(centre.norm(), &cell);
  }
  std::stable_sort(visible.begin(), visible.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<render::PointRun> runs;
  for (const auto& [distance, cell] : visible) {
    runs.push_back(runOf(cell->bounds, pointsOf(*cell), style, view));
  }
  painter.paint(runs, style);
}

double PointCells::closingWidth() const {
  const std::size_t step = std::max<std::size_t>(1, points_.size() / 200);
  std::vector<float> distances;
  std::size_t next = 0;
  for (const auto& cell : cells_) {
    for (; next < cell.first + cell.count; next += step) {
      if (cell.count < 2) continue;
      distances.push_back(nearestNeighbour(pointsOf(cell), next - cell.first));
    }
  }
  if (distances.empty()) return 0.0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  // A voxel's side is this much longer than the distance of points in neighbouring voxels.
  return static_cast<double>(1.5F * *middle);
}

namespace {

/// How the points of the map are drawn.
struct PointDrawing {
  double cell_m = 4.0;               ///< of PointCells
  double occupancy_radius_m = 60.0;  ///< around the robot, at scale 1
  double margin_m = 0.5;             ///< of hidden objects, at scale 1
  double max_width_m = 0.5;          ///< of the dense map's discs
  double max_width_points = 24.0;    ///< of the same in the picture [points]
  double dots_on_dense = 0.65;       ///< width of dots on the dense map to those alone
  double clear_ratio = 0.45;         ///< of the way to the robot that is kept free of points
};
constexpr PointDrawing kDrawing{};

}  // namespace

MapPicture::MapPicture(const SnapshotOptions& options)
    : options_(options),
      palette_(paletteOf(options.theme)),
      painter_(options.width * options.supersampling, options.height * options.supersampling) {}

void MapPicture::updateLandmarks(const SnapshotInput& input, double ground_z) {
  if (static_map_ == input.map.staticMap()) return;
  static_map_ = input.map.staticMap();
  landmarks_ = PointCells(landmarkPoints(*static_map_, ground_z, sceneScale(input), palette_),
                          kDrawing.cell_m);
}

void MapPicture::updateDense(const SnapshotInput& input) {
  const auto dense = options_.dense ? input.map.dense() : nullptr;
  if (dense_map_ == dense) return;
  dense_map_ = dense;
  dense_ =
      dense == nullptr ? PointCells() : PointCells(densePoints(*dense, palette_), kDrawing.cell_m);
  dense_width_m_ = std::min(kDrawing.max_width_m, dense_.closingWidth());
}

cv::Mat MapPicture::draw(const SnapshotInput& input, const render::PinholeView& view,
                         double ground_z) {
  updateLandmarks(input, ground_z);
  updateDense(input);
  const auto drawn = render::enlarged(view, options_.supersampling);
  margin_m_ = kDrawing.margin_m * sceneScale(input);
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
    const double radius = kDrawing.occupancy_radius_m * std::max(0.5, scale);
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
  surface.max_px = pixels(kDrawing.max_width_points * std::max(1.0, pixelsPerPoint(size)));
  surface.near_m = static_cast<float>(kDrawing.clear_ratio * distance);
  dense_.paint(view, surface, painter_);
  render::PointStyle dot;
  dot.min_px = dot.max_px =
      pixels(landmarkWidth(size) * (dense_.empty() ? 1.0 : kDrawing.dots_on_dense));
  dot.nearer_m = static_cast<float>(2.0 * dense_width_m_);
  landmarks_.paint(view, dot, painter_);
}

}  // namespace headway::scene
