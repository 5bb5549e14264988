// SPDX-License-Identifier: BSD-3-Clause
// Cutting a stored map to a box.
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/map/dense_map.h>
#include <headway/map/map_crop.h>
#include <headway/map/static_grid.h>
#include <headway/slam/map_view.h>
#include <headway/slam/stereo_slam.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace headway::map {
namespace {

using mrpt::maps::COccupancyGridMap2D;

Eigen::AlignedBox2d areaOf(const Eigen::AlignedBox3d& box) {
  return {Eigen::Vector2d(box.min().head<2>()), Eigen::Vector2d(box.max().head<2>())};
}

/// The cells whose centres are in the area; null if there are none.
COccupancyGridMap2D::Ptr croppedGrid(const COccupancyGridMap2D& grid,
                                     const Eigen::AlignedBox2d& area) {
  const double cell = grid.getResolution();
  const auto first = [cell](double low, double origin) {
    return std::max(0.0, std::ceil((low - origin) / cell - 0.5));
  };
  const auto end = [cell](double high, double origin, std::size_t count) {
    return std::min(static_cast<double>(count), std::floor((high - origin) / cell - 0.5) + 1.0);
  };
  const double left = first(area.min().x(), grid.getXMin());
  const double bottom = first(area.min().y(), grid.getYMin());
  const double right = end(area.max().x(), grid.getXMin(), grid.getSizeX());
  const double top = end(area.max().y(), grid.getYMin(), grid.getSizeY());
  if (left >= right || bottom >= top) return nullptr;
  auto result = std::make_shared<COccupancyGridMap2D>();
  const auto edge = [cell](double origin, double cells) {
    return static_cast<float>(origin + cells * cell);
  };
  result->setSize(edge(grid.getXMin(), left), edge(grid.getXMin(), right),
                  edge(grid.getYMin(), bottom), edge(grid.getYMin(), top), static_cast<float>(cell),
                  0.5F);
  const auto columns =
      std::min<std::size_t>(result->getSizeX(), static_cast<std::size_t>(right - left));
  const auto rows =
      std::min<std::size_t>(result->getSizeY(), static_cast<std::size_t>(top - bottom));
  for (std::size_t row = 0; row < rows; ++row) {
    const auto* from = grid.getRow(static_cast<int>(bottom) + static_cast<int>(row));
    std::copy_n(from + static_cast<std::size_t>(left), columns,
                result->getRow(static_cast<int>(row)));
  }
  return result;
}

std::string croppedScans(const std::string& scans, double resolution_m,
                         const Eigen::AlignedBox2d& area) {
  StaticGridParams params;
  params.resolution_m = resolution_m;
  StaticGrid grid(params);
  grid.load(scans);
  grid.crop(area);
  return grid.save();
}

void requireKeyframes(const slam::MapView& before, const slam::MapView& after) {
  if (!after.keyframes.empty()) return;
  Eigen::AlignedBox3d bounds;
  for (const auto& keyframe : before.keyframes) bounds.extend(keyframe.T_map_robot.translation());
  if (bounds.isEmpty()) throw InputError("has no keyframes that could be in a box");
  throw InputError(
      formatted("has no keyframe in the box; its keyframes are between x %.1f and "
                "%.1f, y %.1f and %.1f, z %.1f and %.1f m",
                bounds.min().x(), bounds.max().x(), bounds.min().y(), bounds.max().y(),
                bounds.min().z(), bounds.max().z()));
}

}  // namespace

StoredMap cropped(const StoredMap& stored, const Eigen::AlignedBox3d& box) {
  const auto slam = stored.attachments.find(kSlamAttachment);
  if (slam == stored.attachments.end() || !stored.camera) {
    throw InputError("contains no landmarks of a camera, so that it cannot be cropped");
  }
  StoredMap result;
  result.configuration = stored.configuration;
  result.camera = stored.camera;
  const Pose& T_robot_cam = stored.camera->T_robot_cam;
  const std::string& bytes = result.attachments[kSlamAttachment] =
      slam::croppedMap(slam->second, box, T_robot_cam);
  auto view = slam::savedMapView(bytes, T_robot_cam);
  requireKeyframes(*stored.map.staticMap(), view);
  result.map.update(std::move(view));
  const auto grid = stored.map.staticGrid();
  const auto scans = stored.attachments.find(kGridAttachment);
  if (grid != nullptr) {
    if (const auto cells = croppedGrid(*grid, areaOf(box))) result.map.update(cells);
    if (scans != stored.attachments.end()) {
      result.attachments[kGridAttachment] =
          croppedScans(scans->second, grid->getResolution(), areaOf(box));
    }
  }
  const auto depths = stored.attachments.find(kDenseAttachment);
  if (depths != stored.attachments.end()) {
    DenseMap dense({});
    dense.load(depths->second);
    dense.crop(box);
    if (const auto points = dense.layer()) result.map.update(points);
    result.attachments[kDenseAttachment] = collected(dense.save());
  }
  const auto& objects = stored.map.movingObjects();
  std::vector<Track> inside;
  for (const Track& track : objects.tracks()) {
    if (box.contains(track.position)) inside.push_back(track);
  }
  result.map.update(objects.time(), std::move(inside));
  return result;
}

}  // namespace headway::map
