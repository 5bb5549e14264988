// SPDX-License-Identifier: BSD-3-Clause
#include "point_follower.h"

#include <algorithm>
#include <cmath>

#include "interest_points.h"

namespace headway::detect {
namespace {

constexpr stereo::PointTrackingOptions kTracking{9, 3, 18.0, 0.7};
constexpr stereo::PointTrackingOptions kMatching{9, 1, 18.0, 0.0};  // left to right image
constexpr double kMaxRowError = 1.0;    // between the rows in left and right image [px]
constexpr double kMaxDenseError = 2.0;  // between point and dense disparity [px]
constexpr double kMinDisparity = 1.0;   // [px]

}  // namespace

void PointFollower::clear() {
  points_.clear();
  left_before_ = left_ = {};
  right_ = {};
}

Eigen::Vector3d PointFollower::expectedAt(const PointTrack& point, const CameraPath& path) const {
  const Observation& last = point.observations.back();
  const auto in_cam = triangulate(last.uvd, camera_);
  Eigen::Vector3d in_world = path.T_cam_world(last.frame).inverse() * *in_cam;
  if (point.motion && point.group >= 0) {
    in_world += (path.timeOf(path.newest()) - path.timeOf(last.frame)) * point.motion->velocity;
  }
  return project(path.T_cam_world(path.newest()) * in_world, camera_).value_or(last.uvd);
}

void PointFollower::follow(const stereo::FrameContext& context,
                           const stereo::DisparityImage& disparity, const CameraPath& path) {
  left_before_ = std::move(left_);
  left_ = context.left();
  right_ = context.right();
  offset_ = context.disparityOffset();
  if (turn_change_.advance(context)) convert(path);
  if (left_before_.empty() || points_.empty()) return;

  std::vector<Eigen::Vector2d> before;
  std::vector<Eigen::Vector2d> predicted;
  std::vector<double> disparities;
  for (const auto& point : points_) {
    const Eigen::Vector3d expected = expectedAt(point, path);
    before.emplace_back(point.observations.back().uvd.head<2>());
    predicted.emplace_back(expected.head<2>());
    disparities.push_back(expected.z());
  }
  auto positions = stereo::trackPoints(left_before_, left_, before, predicted, kTracking);
  // An object that moves along with the camera is far from where a static point would be.
  stereo::trackMissing(left_before_, left_, before, before, kTracking, positions);
  keepFound(positions, disparitiesOf(positions, disparities, disparity), path);
}

void PointFollower::convert(const CameraPath& path) {
  for (PointTrack& point : points_) turn_change_.apply(point.observations);
  const auto is_lost = [](const PointTrack& point) { return point.observations.empty(); };
  points_.erase(std::remove_if(points_.begin(), points_.end(), is_lost), points_.end());
  fitMotions(path);
}

void PointFollower::fitMotions(const CameraPath& path) {
  const int first = path.firstSince(path.timeOf(path.newest()) - params_.motion_window_s);
  for (PointTrack& point : points_) {
    point.motion = fitMotion(since(first, point.observations), path, camera_, params_.noise,
                             params_.speed_prior);
  }
}

std::vector<std::optional<double>> PointFollower::disparitiesOf(
    const std::vector<stereo::TrackedPosition>& positions, const std::vector<double>& predicted,
    const stereo::DisparityImage& disparity) const {
  if (right_.isDepth()) return givenDisparities(positions);
  std::vector<std::size_t> indices;
  std::vector<Eigen::Vector2d> left;
  std::vector<Eigen::Vector2d> right;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!positions[i]) continue;
    const Eigen::Vector2d& uv = *positions[i];
    const double dense = disparity.at(uv.x(), uv.y());
    indices.push_back(i);
    left.push_back(uv);
    right.emplace_back(uv.x() - (dense > 0.0 ? dense : predicted[i]) - offset_, uv.y());
  }
  const auto matches = stereo::trackPoints(left_, right_.image, left, right, kMatching);
  std::vector<std::optional<double>> result(positions.size());
  for (std::size_t k = 0; k < matches.size(); ++k) {
    if (!matches[k]) continue;
    const double d = left[k].x() - matches[k]->x() - offset_;
    const double dense = disparity.at(left[k].x(), left[k].y());
    const bool same_row = std::abs(left[k].y() - matches[k]->y()) < kMaxRowError;
    const bool agrees = dense <= 0.0 || std::abs(d - dense) < kMaxDenseError;
    if (same_row && agrees && d > kMinDisparity) result[indices[k]] = d;
  }
  return result;
}

std::vector<std::optional<double>> PointFollower::givenDisparities(
    const std::vector<stereo::TrackedPosition>& positions) const {
  std::vector<std::optional<double>> result(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!positions[i]) continue;
    const auto given = stereo::givenDisparity(right_.disparities, *positions[i]);
    if (given && *given - offset_ > kMinDisparity) result[i] = *given - offset_;
  }
  return result;
}

void PointFollower::keepFound(const std::vector<stereo::TrackedPosition>& positions,
                              const std::vector<std::optional<double>>& disparities,
                              const CameraPath& path) {
  std::vector<PointTrack> kept;
  kept.reserve(points_.size());
  const Time now = path.timeOf(path.newest());
  const auto isOld = [&](const Observation& observation) {
    return observation.frame < path.oldest() ||
           path.timeOf(observation.frame) < now - params_.window_s - 1e-6;
  };
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!positions[i] || !disparities[i]) continue;
    const Eigen::Vector2d& uv = *positions[i];
    const bool inside = uv.x() >= 0.0 && uv.y() >= 0.0 && uv.x() < camera_.width - 1.0 &&
                        uv.y() < camera_.height - 1.0;
    if (!inside) continue;
    PointTrack point = std::move(points_[i]);
    point.observations.push_back({path.newest(), {uv.x(), uv.y(), *disparities[i]}});
    point.observations.erase(
        point.observations.begin(),
        std::find_if_not(point.observations.begin(), point.observations.end(), isOld));
    kept.push_back(std::move(point));
  }
  points_ = std::move(kept);
}

void PointFollower::replenish(const StereoFrame& frame, const stereo::DisparityImage& disparity,
                              const std::optional<stereo::GroundPlane>& ground, int frame_number) {
  if (left_.empty()) return;
  std::vector<cv::Point2f> taken;
  for (const auto& point : points_) {
    const auto& uvd = point.observations.back().uvd;
    taken.emplace_back(static_cast<float>(uvd.x()), static_cast<float>(uvd.y()));
  }
  const int wanted = params_.max_points - static_cast<int>(points_.size());
  const InterestZone zone{params_.range_m, params_.max_height_m, params_.people_m};
  const auto chosen = interestPoints(frame.left, disparity, camera_, ground, zone, taken,
                                     params_.spacing_px, wanted);
  std::vector<stereo::TrackedPosition> positions;
  std::vector<double> dense;
  for (const auto& place : chosen) {
    positions.emplace_back(Eigen::Vector2d(place.x, place.y));
    dense.push_back(disparity.at(place.x, place.y));
  }
  const auto disparities = disparitiesOf(positions, dense, disparity);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!disparities[i]) continue;
    PointTrack point;
    point.id = next_id_++;
    point.observations.push_back(
        {frame_number, {positions[i]->x(), positions[i]->y(), *disparities[i]}});
    points_.push_back(std::move(point));
  }
}

}  // namespace headway::detect
