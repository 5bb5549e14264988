// SPDX-License-Identifier: BSD-3-Clause
#include "object_pieces.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "range.h"

namespace headway::detect {
namespace {

// Directive 96/53/EC: an articulated vehicle.
constexpr double kMaxLength = 16.5;            // [m]
constexpr double kMaxWidth = 2.6;              // [m]
constexpr double kWidthPerLength = 0.1;        // by an error of the direction of motion [m/m]
constexpr double kTouch = 0.5;                 // greatest gap between pieces [m]
constexpr double kMaxSquaredDifference = 9.2;  // of velocities: 99 % of chi-square, 2 degrees
constexpr double kVelocityRatio = 0.05;        // of a speed, error common to a piece [-]

double gap(const Range& a, const Range& b) { return std::max({0.0, a.min - b.max, b.min - a.max}); }

Range both(const Range& a, const Range& b) {
  return {std::min(a.min, b.min), std::max(a.max, b.max)};
}

/// What is seen of an object, along its motion and across it.
struct Seen {
  Range along, across;
};

Seen seenOf(const std::vector<ObjectCell>& cells, const Eigen::Vector3d& front,
            const Eigen::Vector3d& up) {
  const Eigen::Vector3d side = up.cross(front);
  Seen seen;
  for (const auto& cell : cells) {
    seen.along.add(front.dot(cell.point));
    seen.across.add(side.dot(cell.point));
  }
  return seen;
}

std::vector<ObjectCell> cellsOf(const MovingObject& object, const stereo::DisparityImage& disparity,
                                const StereoCamera& camera) {
  std::vector<ObjectCell> cells;
  for (const auto& place : object.extent.cells) {
    const auto point = triangulate(
        {disparity.pixelOf(place.x), disparity.pixelOf(place.y), disparity.values.at<float>(place)},
        camera);
    if (point) cells.push_back({place, *point});
  }
  return cells;
}

bool isFastVehicle(const MovingObject& a, const MovingObject& b) {
  return a.evidence.motion && b.evidence.motion &&
         std::min(a.velocity.value.norm(), b.velocity.value.norm()) > kFastestWalker &&
         (isVehicle(a.extent.object_class) || isVehicle(b.extent.object_class));
}

bool moveAlike(const MovingObject& a, const MovingObject& b, const Eigen::Vector3d& up) {
  const Eigen::Vector3d difference = a.velocity.value - b.velocity.value;
  const double common = kVelocityRatio * std::max(a.velocity.value.norm(), b.velocity.value.norm());
  // Along the ground; velocities have no part across it.
  const Eigen::Matrix3d covariance = a.velocity.covariance + b.velocity.covariance +
                                     common * common * Eigen::Matrix3d::Identity() +
                                     up * up.transpose();
  return difference.dot(covariance.inverse() * difference) < kMaxSquaredDifference;
}

MeasuredVelocity meanOf(const MeasuredVelocity& a, const MeasuredVelocity& b,
                        const Eigen::Vector3d& up) {
  const Eigen::Matrix3d upright = up * up.transpose();  // singular otherwise
  const Eigen::Matrix3d of_a = (a.covariance + upright).inverse();
  const Eigen::Matrix3d of_b = (b.covariance + upright).inverse();
  const Eigen::Matrix3d covariance = (of_a + of_b).inverse();
  const Eigen::Vector3d mean = covariance * (of_a * a.value + of_b * b.value);
  return {mean - up * up.dot(mean), covariance};
}

class Joiner {
 public:
  Joiner(const MotionFrame& frame, const StereoCamera& camera) : frame_(frame), camera_(camera) {}

  /// nullopt if the two are not pieces of one vehicle.
  [[nodiscard]] std::optional<MovingObject> joined(const MovingObject& a,
                                                   const MovingObject& b) const {
    if (!isFastVehicle(a, b) || !moveAlike(a, b, frame_.up)) return std::nullopt;
    const auto velocity = meanOf(a.velocity, b.velocity, frame_.up);
    const Eigen::Matrix3d R_cam_world = frame_.path.T_cam_world(frame_.path.newest()).linear();
    auto cells = cellsOf(a, frame_.disparity, camera_);
    const auto more = cellsOf(b, frame_.disparity, camera_);
    const Eigen::Vector3d front = (R_cam_world * velocity.value).normalized();
    const Eigen::Vector3d up = R_cam_world * frame_.up;
    const double depth = std::max(a.extent.surface.z(), b.extent.surface.z());
    if (!areOne(seenOf(cells, front, up), seenOf(more, front, up), depth)) return std::nullopt;
    cells.insert(cells.end(), more.begin(), more.end());
    auto extent = extentOf(cells, rotated(velocity, R_cam_world), frame_.disparity, camera_,
                           floorUnder(cells));
    if (!extent) return std::nullopt;
    MovingObject whole = a.points < b.points ? b : a;
    const MovingObject& other = a.points < b.points ? a : b;
    whole.extent = std::move(*extent);
    whole.velocity = velocity;
    whole.first_frame = std::min(a.first_frame, b.first_frame);
    whole.points += other.points;
    whole.members.insert(whole.members.end(), other.members.begin(), other.members.end());
    whole.segments.insert(whole.segments.end(), other.segments.begin(), other.segments.end());
    return whole;
  }

 private:
  [[nodiscard]] bool areOne(const Seen& a, const Seen& b, double depth) const {
    const double noise = kCellSigma * depth * depth / (camera_.fx * camera_.baseline_m);
    if (std::hypot(gap(a.along, b.along), gap(a.across, b.across)) > kTouch + noise) return false;
    const double length = both(a.along, b.along).size();
    const double width = both(a.across, b.across).size();
    return length < kMaxLength && width < kMaxWidth + kWidthPerLength * length + noise;
  }

  [[nodiscard]] stereo::GroundPlane floorUnder(const std::vector<ObjectCell>& cells) const {
    if (frame_.ground) return *frame_.ground;
    std::vector<Eigen::Vector3d> points;
    for (const auto& cell : cells) points.push_back(cell.point);
    return floorBelow(points, camera_);
  }

  const MotionFrame& frame_;
  const StereoCamera& camera_;
};

}  // namespace

void joinPieces(const MotionFrame& frame, const StereoCamera& camera,
                std::vector<MovingObject>& objects) {
  const Joiner joiner(frame, camera);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (std::size_t j = i + 1; j < objects.size();) {
      auto whole = joiner.joined(objects[i], objects[j]);
      if (!whole) {
        ++j;
        continue;
      }
      objects[i] = std::move(*whole);
      objects.erase(objects.begin() + static_cast<std::ptrdiff_t>(j));
      j = i + 1;  // the whole may touch what its pieces did not
    }
  }
}

}  // namespace headway::detect
