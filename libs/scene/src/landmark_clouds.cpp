#include "landmark_clouds.h"

#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfObjects.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "draw_order.h"
#include "palette.h"

namespace headway::scene {
namespace {

constexpr double kCellM = 30.0;
constexpr std::size_t kThinning = 3;        ///< from one level to the next
constexpr double kRoomForPoint_px2 = 16.0;  ///< of the picture, about twice what a point covers

/// Grey as in the image, lifted off the dark ground, and tinted from blue (low) to sand (high).
mrpt::img::TColor colourOf(const slam::LandmarkView& landmark, double ground_z) {
  const double brightness = 0.55 + 0.45 * landmark.intensity / 255.0;
  const double height = std::clamp((landmark.position.z() - ground_z) / 6.0, 0.0, 1.0);
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
  drawInOrder(DrawOrder::kLandmarks, *cloud);
  return cloud;
}

/// Whether a part of a ball around the box can be in the picture.
bool mayBeSeen(const Eigen::AlignedBox3d& bounds, const render::PinholeView& view) {
  const double radius = 0.5 * bounds.diagonal().norm();
  const Eigen::Vector3d middle = view.T_map_camera.inverse() * bounds.center();
  if (middle.z() < view.near_m - radius || middle.z() > view.far_m + radius) return false;
  const double tan_x = 0.5 * view.width / view.fx;
  const double tan_y = 0.5 * view.height / view.fy;
  return std::abs(middle.x()) <= middle.z() * tan_x + radius * std::sqrt(1.0 + tan_x * tan_x) &&
         std::abs(middle.y()) <= middle.z() * tan_y + radius * std::sqrt(1.0 + tan_y * tan_y);
}

/// How many points the picture of the box has room for; as many as there are if it surrounds the
/// eye.
double roomFor(const Eigen::AlignedBox3d& bounds, const render::PinholeView& view) {
  Eigen::AlignedBox2d covered;
  for (int corner = 0; corner < 8; ++corner) {
    const auto pixel =
        render::project(bounds.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)), view);
    if (!pixel) return std::numeric_limits<double>::infinity();
    covered.extend(*pixel);
  }
  return covered.volume() / kRoomForPoint_px2;
}

}  // namespace

void LandmarkClouds::update(const std::shared_ptr<const slam::MapView>& still_world,
                            double ground_z, float point_size) {
  if (shown_world_ == still_world) return;
  shown_world_ = still_world;
  cells_.clear();
  for (const auto& landmark : still_world->landmarks) {
    const Eigen::Vector3d& position = landmark.position;
    auto& cell = cells_[{static_cast<int>(std::floor(position.x() / kCellM)),
                         static_cast<int>(std::floor(position.y() / kCellM))}];
    if (cell.thinned.front() == nullptr) {
      for (auto& cloud : cell.thinned) cloud = newCloud(point_size);
    }
    cell.bounds.extend(position);
    const auto colour = colourOf(landmark, ground_z);
    const Eigen::Vector3f p = position.cast<float>();
    const mrpt::math::TPointXYZfRGBAu8 point(p.x(), p.y(), p.z(), colour.R, colour.G, colour.B,
                                             colour.A);
    std::size_t place = cell.thinned.front()->size();
    for (auto& cloud : cell.thinned) {
      cloud->insertPoint(point);
      if (place % kThinning != 0) break;
      place /= kThinning;
    }
  }
}

void LandmarkClouds::insertAll(mrpt::opengl::CSetOfObjects& out) const {
  for (const auto& [index, cell] : cells_) out.insert(cell.thinned.front());
}

void LandmarkClouds::insertVisible(const render::PinholeView& view,
                                   mrpt::opengl::CSetOfObjects& out) const {
  for (const auto& [index, cell] : cells_) {
    if (!mayBeSeen(cell.bounds, view)) continue;
    const double room = roomFor(cell.bounds, view);
    const auto fits =
        std::find_if(cell.thinned.begin(), cell.thinned.end(),
                     [&](const auto& cloud) { return static_cast<double>(cloud->size()) <= room; });
    out.insert(fits == cell.thinned.end() ? cell.thinned.back() : *fits);
  }
}

}  // namespace headway::scene
