// SPDX-License-Identifier: BSD-3-Clause
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfObjects.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "canvas.h"
#include "world_scene.h"

namespace headway::scene {
namespace {

constexpr double kCellSizeM = 30.0;
constexpr double kHighM = 6.0;           ///< of the highest tint above the ground, at scale 1
constexpr std::size_t kSubsampling = 3;  ///< factor between levels
constexpr double kDotWidth = 2.6;        ///< [points]
constexpr double kDotSpacing = 4.0;      ///< of dots that can be told apart [points]

/// Image intensity, brightened for the dark background and tinted by height: blue (low) to sand
/// (high).
mrpt::img::TColor colourOf(const slam::LandmarkView& landmark, double ground_z, double scale) {
  const double brightness = 0.55 + 0.45 * landmark.intensity / 255.0;
  const double height =
      std::clamp((landmark.position.z() - ground_z) / (kHighM * std::max(0.4, scale)), 0.0, 1.0);
  const auto mix = [&](std::uint8_t low, std::uint8_t high) {
    return static_cast<std::uint8_t>(brightness * (low + height * (high - low)));
  };
  return {mix(kLowColour.red, kHighColour.red), mix(kLowColour.green, kHighColour.green),
          mix(kLowColour.blue, kHighColour.blue), 255};
}

std::shared_ptr<mrpt::opengl::CPointCloudColoured> newCloud(float point_size) {
  auto cloud = mrpt::opengl::CPointCloudColoured::Create();
  cloud->setName("points");
  cloud->setPointSize(point_size);
  cloud->enableVariablePointSize(false);
  setDrawOrder(DrawOrder::kLandmarks, *cloud);
  return cloud;
}

/// Whether the bounding sphere of the box intersects the viewing frustum.
bool mayBeVisible(const Eigen::AlignedBox3d& bounds, const render::PinholeView& view) {
  const double radius = 0.5 * bounds.diagonal().norm();
  const Eigen::Vector3d centre = view.T_map_camera.inverse() * bounds.center();
  if (centre.z() < view.near_m - radius || centre.z() > view.far_m + radius) return false;
  const double tan_x = 0.5 * view.width / view.fx;
  const double tan_y = 0.5 * view.height / view.fy;
  return std::abs(centre.x()) <= centre.z() * tan_x + radius * std::sqrt(1.0 + tan_x * tan_x) &&
         std::abs(centre.y()) <= centre.z() * tan_y + radius * std::sqrt(1.0 + tan_y * tan_y);
}

/// Number of dots that the projection of the box can resolve; infinite if a corner is behind the
/// camera.
double pointCapacity(const Eigen::AlignedBox3d& bounds, const render::PinholeView& view) {
  Eigen::AlignedBox2d covered;
  for (int corner = 0; corner < 8; ++corner) {
    const auto pixel =
        render::project(bounds.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)), view);
    if (!pixel) return std::numeric_limits<double>::infinity();
    covered.extend(*pixel);
  }
  const double spacing_px = kDotSpacing / kDotWidth * landmarkWidth({view.width, view.height});
  return covered.volume() / (spacing_px * spacing_px);
}

}  // namespace

double landmarkWidth(const cv::Size& picture) {
  return kDotWidth * std::max(1.0, pixelsPerPoint(picture));
}

void LandmarkClouds::update(const std::shared_ptr<const slam::MapView>& static_map, double ground_z,
                            double scale, float point_size) {
  if (current_map_ == static_map) return;
  current_map_ = static_map;
  cells_.clear();
  for (const auto& landmark : static_map->landmarks) {
    const Eigen::Vector3d& position = landmark.position;
    auto& cell = cells_[{static_cast<int>(std::floor(position.x() / kCellSizeM)),
                         static_cast<int>(std::floor(position.y() / kCellSizeM))}];
    if (cell.levels.front() == nullptr) {
      for (auto& cloud : cell.levels) cloud = newCloud(point_size);
    }
    cell.bounds.extend(position);
    const auto colour = colourOf(landmark, ground_z, scale);
    const Eigen::Vector3f p = position.cast<float>();
    const mrpt::math::TPointXYZfRGBAu8 point(p.x(), p.y(), p.z(), colour.R, colour.G, colour.B,
                                             colour.A);
    std::size_t index = cell.levels.front()->size();
    for (auto& cloud : cell.levels) {
      cloud->insertPoint(point);
      if (index % kSubsampling != 0) break;
      index /= kSubsampling;
    }
  }
}

void LandmarkClouds::insertAll(mrpt::opengl::CSetOfObjects& out) const {
  for (const auto& [index, cell] : cells_) out.insert(cell.levels.front());
}

void LandmarkClouds::insertVisible(const render::PinholeView& view,
                                   mrpt::opengl::CSetOfObjects& out) const {
  for (const auto& [index, cell] : cells_) {
    if (!mayBeVisible(cell.bounds, view)) continue;
    const double capacity = pointCapacity(cell.bounds, view);
    const auto fits = std::find_if(cell.levels.begin(), cell.levels.end(), [&](const auto& cloud) {
      return static_cast<double>(cloud->size()) <= capacity;
    });
    out.insert(fits == cell.levels.end() ? cell.levels.back() : *fits);
  }
}

}  // namespace headway::scene
