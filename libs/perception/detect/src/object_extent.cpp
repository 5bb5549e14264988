// SPDX-License-Identifier: BSD-3-Clause
// Extent of an object: its cells of the disparity image, its boxes and its class by size.
#include "object_extent.h"

#include <headway/detect/stereo_lifter.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "point_motion.h"

namespace headway::detect {
namespace {

constexpr double kStep = 1.0;             // of disparity between neighbouring cells [px]
constexpr double kStepRatio = 0.04;       // or this ratio of it
constexpr double kReach = 0.7;            // over the ground, from the nearest seed [m]
constexpr double kReachPerMetre = 0.015;  // growth of the reach with depth [m/m]
constexpr double kMaxHeight = 3.8;        // above ground [m]
constexpr double kMinHeight = 0.4;        // of what is seen of a moving object [m]
constexpr double kMaxAfloat = 1.2;        // lowest part above ground, stereo noise aside [m]
constexpr double kMinAfloat = 0.35;       // of something that the view below it is tested of [m]
constexpr double kTail = 0.03;            // of the cells left out at each end of an extent
constexpr double kVehicleExtent = 1.35;   // a person is never this wide [m]
constexpr double kFastestCyclist = 10.0;  // [m/s]
constexpr double kEdgeSigma = 3.0;        // of an extent's edge in the image [px]
constexpr double kDisparitySpread = 2.0;  // by noise, of one surface between the tails [px]
// Where three sigmas of a depth exceed a vehicle's extent, only extents across the sight are known.

using Cell = ObjectCell;

class Growth {
 public:
  Growth(const std::vector<Eigen::Vector3d>& seeds, const stereo::DisparityImage& disparity,
         const StereoCamera& camera, const stereo::GroundPlane& ground)
      : seeds_(seeds), disparity_(disparity), camera_(camera), ground_(ground) {}

  std::vector<Cell> run() {
    cv::Mat seen(disparity_.values.size(), CV_8U, cv::Scalar(0));
    for (const auto& seed : seeds_) {
      const auto uvd = project(seed, camera_);
      if (!uvd) continue;
      const cv::Point place(disparity_.cellOf(uvd->x()), disparity_.cellOf(uvd->y()));
      visit(place, static_cast<float>(uvd->z()), seen);
    }
    for (std::size_t next = 0; next < cells_.size(); ++next) {
      const cv::Point place = cells_[next].place;
      const float d = disparity_.values.at<float>(place);
      // Two cells on: small holes of the disparity image do not cut an object in two.
      for (const auto& step :
           {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1), cv::Point(2, 0),
            cv::Point(-2, 0), cv::Point(0, 2), cv::Point(0, -2)}) {
        visit(place + step, d, seen);
      }
    }
    return std::move(cells_);
  }

 private:
  void visit(const cv::Point& place, float from, cv::Mat& seen) {
    if (!cv::Rect({0, 0}, seen.size()).contains(place) || seen.at<unsigned char>(place) != 0) {
      return;
    }
    const float d = disparity_.values.at<float>(place);
    if (d <= 0.0F || std::abs(d - from) > std::max(kStep, kStepRatio * d)) return;
    const auto point =
        triangulate({disparity_.pixelOf(place.x), disparity_.pixelOf(place.y), d}, camera_);
    if (ground_.isGround(*point) || ground_.heightOf(*point) > kMaxHeight) return;
    if (!nearSeeds(*point)) return;
    seen.at<unsigned char>(place) = 1;
    cells_.push_back({place, *point});
  }

  [[nodiscard]] bool nearSeeds(const Eigen::Vector3d& point) const {
    const double reach = kReach + kReachPerMetre * point.z();
    return std::any_of(seeds_.begin(), seeds_.end(), [&](const Eigen::Vector3d& seed) {
      return overGround(point - seed, ground_.up).squaredNorm() < reach * reach;
    });
  }

  const std::vector<Eigen::Vector3d>& seeds_;
  const stereo::DisparityImage& disparity_;
  const StereoCamera& camera_;
  const stereo::GroundPlane& ground_;
  std::vector<Cell> cells_;
};

template <typename Value>
Range rangeOf(const std::vector<Cell>& cells, double tail, Value value) {
  std::vector<double> values;
  values.reserve(cells.size());
  for (const auto& cell : cells) values.push_back(value(cell));
  const auto skip = static_cast<std::ptrdiff_t>(tail * static_cast<double>(values.size()));
  const auto at_min = values.begin() + skip, at_max = values.end() - 1 - skip;
  std::nth_element(values.begin(), at_min, values.end());
  const double min = *at_min;
  std::nth_element(at_min, at_max, values.end());  // none of these is less
  return {min, *at_max};
}

// Ratio of the columns of cells below which, down to the ground, something farther is visible:
// nothing hides the lower part of what stands on the ground there, so their disparities are wrong.
double seenBelow(const std::vector<Cell>& cells, const stereo::DisparityImage& disparity,
                 const StereoCamera& camera, const stereo::GroundPlane& floor) {
  std::map<int, const Cell*> lowest;  // by column
  for (const auto& cell : cells) {
    const Cell*& low = lowest.try_emplace(cell.place.x, &cell).first->second;
    if (cell.place.y > low->place.y) low = &cell;
  }
  double seen = 0.0;
  for (const auto& [column, cell] : lowest) {
    const int row = cell->place.y;
    const float d = disparity.values.at<float>(row, column);
    const double farther = d - std::max(kFarther_px, kFartherRatio * d);
    const auto foot = project(cell->point - floor.heightOf(cell->point) * floor.up, camera);
    const int end = foot ? std::min(disparity.values.rows, disparity.cellOf(foot->y())) : row;
    for (int below = row + 1; below < end; ++below) {
      const float other = disparity.values.at<float>(below, column);
      if (other <= 0.0F || other >= farther) continue;
      seen += 1.0;
      break;
    }
  }
  return seen / static_cast<double>(lowest.size());
}

// Larger extent over the ground, as far as it does not follow from errors of the depth, whose
// spread adds to the true one in squares [m].
//
// @param per_px  change of the depth by a pixel of disparity [m/px]
double knownExtent(const std::vector<Cell>& cells, const Eigen::Vector3d& middle,
                   const Eigen::Vector3d& front, double per_px, const stereo::GroundPlane& ground) {
  const auto extentAlong = [&](const Eigen::Vector3d& axis) {
    return rangeOf(cells, kTail, [&](const Cell& c) { return axis.dot(c.point); }).size();
  };
  if (kSureSigmas * kCellSigma * per_px > kVehicleExtent) {
    return extentAlong(ground.up.cross(middle).normalized());
  }
  const Eigen::Vector3d side = ground.up.cross(front);
  const auto knownAlong = [&](const Eigen::Vector3d& axis) {
    const double extent = extentAlong(axis);
    const double noise = kDisparitySpread * per_px * axis.z();
    return std::sqrt(std::max(0.0, extent * extent - noise * noise));
  };
  return std::max(knownAlong(front), knownAlong(side));
}

// Whether the image shows too little of something for an object that people or vehicles are: lower
// than half of it may be hidden by something before it, but what the image's edge cuts off may be
// larger.
bool isTooLow(const Box2d& box, double depth, const StereoCamera& camera) {
  if (box.top <= 1.0 || box.bottom >= camera.height - 2.0) return false;
  return (box.bottom - box.top) * depth < kMinHeight * camera.fy;
}

// Most probable class of an object of this size and speed.
ObjectClass classBySize(double extent, double height, const MeasuredVelocity& velocity) {
  const double speed = velocity.value.norm();
  const double sigma = sigmaAlong(velocity.value, velocity.covariance);
  if (extent > kVehicleExtent || speed - 2.0 * sigma > kFastestCyclist) {
    if (height > kMaxVanHeight_m) return ObjectClass::kTruck;
    return height > 1.9 ? ObjectClass::kVan : ObjectClass::kCar;
  }
  return speed > kFastestWalker ? ObjectClass::kCyclist : ObjectClass::kPedestrian;
}

// Stretches the seen part of an extent to a usual one, away from the camera.
Range completed(const Range& seen, double usual, double camera_side) {
  if (seen.size() >= usual) return seen;
  const double mean = 0.5 * (seen.min + seen.max);
  const double missing = usual - seen.size();
  // The side turned to the camera is seen; what is missing lies behind it, and where the camera
  // looks at the extent broadside it may be missing on both sides.
  const double behind = std::clamp(0.5 + (mean - camera_side) / usual, 0.0, 1.0);
  return {seen.min - (1.0 - behind) * missing, seen.max + behind * missing};
}

Box3d boxAround(const std::vector<Cell>& cells, const Eigen::Vector3d& front,
                const stereo::GroundPlane& ground, ObjectClass object_class) {
  const Eigen::Vector3d side = ground.up.cross(front);
  const auto usual = classSize(object_class)->size;
  Range along = rangeOf(cells, kTail, [&](const Cell& c) { return front.dot(c.point); });
  Range across = rangeOf(cells, kTail, [&](const Cell& c) { return side.dot(c.point); });
  const Range height =
      rangeOf(cells, kTail, [&](const Cell& c) { return ground.heightOf(c.point); });
  along = completed(along, usual.x(), 0.0);
  across = completed(across, usual.y(), 0.0);
  const double top = std::max(height.max, 0.6 * usual.z());
  Box3d box;
  box.length = along.size();
  box.width = across.size();
  box.height = top;
  box.yaw = opticalYaw(front);
  box.centre = 0.5 * (along.min + along.max) * front + 0.5 * (across.min + across.max) * side +
               (0.5 * top - ground.camera_height) * ground.up;
  return box;
}

}  // namespace

stereo::GroundPlane floorBelow(const std::vector<Eigen::Vector3d>& points,
                               const StereoCamera& camera) {
  const Eigen::Vector3d up = stereo::mountedUp(camera);
  double lowest = std::numeric_limits<double>::infinity();
  for (const auto& point : points) lowest = std::min(lowest, up.dot(point));
  return stereo::groundPlane(stereo::rigCapability(camera), up, 0.5 - lowest);
}

std::vector<ObjectCell> growObject(const std::vector<Eigen::Vector3d>& seeds,
                                   const stereo::DisparityImage& disparity,
                                   const StereoCamera& camera, const stereo::GroundPlane& ground) {
  return Growth(seeds, disparity, camera, ground).run();
}

std::optional<ObjectExtent> extentOf(const std::vector<ObjectCell>& cells,
                                     const MeasuredVelocity& velocity,
                                     const stereo::DisparityImage& disparity,
                                     const StereoCamera& camera, const stereo::GroundPlane& floor) {
  if (cells.size() < 4) return std::nullopt;
  ObjectExtent extent;
  const Range u = rangeOf(cells, 0.01, [&](const Cell& c) { return disparity.pixelOf(c.place.x); });
  const Range v = rangeOf(cells, 0.01, [&](const Cell& c) { return disparity.pixelOf(c.place.y); });
  const double half = 0.5 * disparity.reduce;
  extent.box2d = {std::max(0.0, u.min - half), std::max(0.0, v.min - half),
                  std::min(camera.width - 1.0, u.max + half),
                  std::min(camera.height - 1.0, v.max + half)};
  const Eigen::Vector3d front = velocity.value.isZero()
                                    ? overGround(cells.front().point, floor.up).normalized()
                                    : velocity.value.normalized();
  const Range height =
      rangeOf(cells, kTail, [&](const Cell& c) { return floor.heightOf(c.point); });
  if (height.min > kMaxAfloat) return std::nullopt;
  if (height.min > kMinAfloat && seenBelow(cells, disparity, camera, floor) > 0.5)
    return std::nullopt;
  for (const auto& cell : cells) {
    extent.cells.push_back(cell.place);
    extent.surface += cell.point / static_cast<double>(cells.size());
  }
  const double depth = extent.surface.z();
  if (isTooLow(extent.box2d, depth, camera)) return std::nullopt;
  const double per_px = depth * depth / (camera.fx * camera.baseline_m);
  const double seen = knownExtent(cells, extent.surface, front, per_px, floor);
  extent.object_class = classBySize(seen, height.max, velocity);
  extent.box = boxAround(cells, front, floor, extent.object_class);
  const Eigen::Vector3d sight = extent.box.centre.normalized();
  const double across = kEdgeSigma * extent.box.centre.z() / camera.fx + 0.1;
  const double along = std::hypot(across, kSurfaceSigma_px * per_px + 0.1 * extent.box.length);
  extent.centre_covariance = across * across * Eigen::Matrix3d::Identity() +
                             (along * along - across * across) * sight * sight.transpose();
  return extent;
}

}  // namespace headway::detect
