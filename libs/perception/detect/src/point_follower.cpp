// SPDX-License-Identifier: BSD-3-Clause
// Points of the image followed from frame to frame: which are chosen, where they are found again.
#include "point_follower.h"

#include <headway/core/statistics.h>
#include <headway/stereo/disparity.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "object_extent.h"

namespace headway::detect {
namespace {

constexpr int kReduce = 2;
constexpr int kBorder = 8;               // from the image's edges [px]
constexpr float kMinStrength = 2e-4F;    // smaller eigenvalue, of an image scaled to 0 ... 1
constexpr float kOfPeople = 8.0F;        // corners where people may be count so much stronger
constexpr double kElsewhereRatio = 0.1;  // of the points, outside of the zone

struct Corner {
  float strength = 0.0F;
  cv::Point2f place;
  bool in_zone = false;
};

bool inZone(const cv::Point2f& place, double disparity, const StereoCamera& camera,
            const std::optional<stereo::GroundPlane>& ground, const InterestZone& zone) {
  const auto point = triangulate({place.x, place.y, disparity}, camera);
  if (point->z() > zone.range_m) return false;
  if (!ground) return true;
  return !ground->isGround(*point) && ground->heightOf(*point) < zone.max_height_m;
}

// Strongest pixel of a square of the reduced image.
Corner strongestIn(const cv::Mat& strength, const cv::Rect& square) {
  Corner best;
  for (int row = square.y; row < square.y + square.height; ++row) {
    const float* values = strength.ptr<float>(row);
    for (int column = square.x; column < square.x + square.width; ++column) {
      if (values[column] <= best.strength) continue;
      best.strength = values[column];
      best.place = {(static_cast<float>(column) + 0.5F) * kReduce - 0.5F,
                    (static_cast<float>(row) + 0.5F) * kReduce - 0.5F};
    }
  }
  return best;
}

// The strongest corner of each free square, with more weight where people may be.
std::vector<Corner> cornersIn(const cv::Mat& strength, const cv::Mat& occupied, int side,
                              const stereo::DisparityImage& disparity, const StereoCamera& camera,
                              const std::optional<stereo::GroundPlane>& ground,
                              const InterestZone& zone) {
  std::vector<Corner> corners;
  const int border = (kBorder / kReduce + side - 1) / side * side;  // whole squares
  for (int row = border; row + side + border < strength.rows; row += side) {
    for (int column = border; column + side + border < strength.cols; column += side) {
      if (occupied.at<unsigned char>(row / side, column / side) != 0) continue;
      Corner corner = strongestIn(strength, {column, row, side, side});
      if (corner.strength * kOfPeople < kMinStrength) continue;
      const double d = disparity.at(corner.place.x, corner.place.y);
      if (d <= 0.0) continue;
      if (inZone(corner.place, d, camera, ground, {zone.people_m, kHeadHeight, zone.people_m})) {
        corner.strength *= kOfPeople;
      }
      if (corner.strength < kMinStrength) continue;
      corner.in_zone = inZone(corner.place, d, camera, ground, zone);
      corners.push_back(corner);
    }
  }
  return corners;
}

constexpr double kMaxRowError = 1.0;    // between the rows in left and right image [px]
constexpr double kMaxDenseError = 2.0;  // between point and dense disparity [px]

}  // namespace

std::vector<cv::Point2f> interestPoints(
    const cv::Mat& image, const stereo::DisparityImage& disparity, const StereoCamera& camera,
    const std::optional<stereo::GroundPlane>& ground, const InterestZone& zone,
    const std::vector<cv::Point2f>& taken, int spacing_px, int wanted) {
  if (wanted <= 0) return {};
  cv::Mat strength;
  cv::cornerMinEigenVal(stereo::reducedImage(image, kReduce), strength, 3, 3);
  const int side = std::max(2, spacing_px / kReduce);
  cv::Mat occupied(strength.rows / side + 1, strength.cols / side + 1, CV_8U, cv::Scalar(0));
  for (const auto& place : taken) {
    const int row = static_cast<int>(place.y) / kReduce / side;
    const int column = static_cast<int>(place.x) / kReduce / side;
    occupied.at<unsigned char>(row, column) = 1;
  }
  auto corners = cornersIn(strength, occupied, side, disparity, camera, ground, zone);
  std::stable_sort(corners.begin(), corners.end(),
                   [](const Corner& a, const Corner& b) { return a.strength > b.strength; });
  auto elsewhere = static_cast<int>(kElsewhereRatio * wanted);
  auto in_zone = wanted - elsewhere;
  std::vector<cv::Point2f> chosen;
  for (const auto& corner : corners) {
    int& left = corner.in_zone ? in_zone : elsewhere;
    if (left <= 0) continue;
    --left;
    chosen.push_back(corner.place);
  }
  return chosen;
}

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
  auto positions = stereo::trackPoints(left_before_, left_, before, predicted, {});
  // An object that moves along with the camera is far from where a static point would be.
  stereo::trackMissing(left_before_, left_, before, before, {}, positions);
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
  auto result =
      right_.isDepth() ? givenDisparities(positions) : matched(positions, predicted, disparity);
  stereo::DisparityImage nearest = disparity;
  // Half a window at full resolution, and at half of it.
  const int reach_px = stereo::PointTrackingOptions().window_px - 1;
  nearest.values = stereo::nearestAround(disparity.values, reach_px / disparity.reduce);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!result[i]) continue;
    const double around = nearest.at(positions[i]->x(), positions[i]->y());
    if (around > stereo::nearerThan(*result[i])) result[i].reset();
  }
  return result;
}

std::vector<std::optional<double>> PointFollower::matched(
    const std::vector<stereo::TrackedPosition>& positions, const std::vector<double>& predicted,
    const stereo::DisparityImage& disparity) const {
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
  stereo::PointTrackingOptions options;
  options.coarsest_level = 1;
  options.max_return_error = 0.0;  // the rows and dense disparities are the test
  const auto matches = stereo::trackPoints(left_, right_.image, left, right, options);
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
           path.timeOf(observation.frame) < now - params_.window_s - kFrameJitter_s;
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

void NoiseScale::update(const std::vector<PointTrack>& points, double seconds) {
  constexpr std::size_t kMinPoints = 30;
  constexpr double kMedianOfChi = 0.93;  // of a chi-square of 9 degrees of freedom, over its mean
  constexpr double kNewWeight = 0.2;     // of a new value after 0.1 s
  std::vector<double> fits;
  for (const auto& point : points) {
    if (!point.motion || point.group >= 0 || point.motion->observations < kMinFitted) continue;
    fits.push_back(point.motion->staticFit());
  }
  if (fits.size() < kMinPoints) return;
  const double now = std::clamp(std::sqrt(median(fits) / kMedianOfChi), 0.4, 3.0);
  value_ += (1.0 - std::pow(1.0 - kNewWeight, tenthsOf(seconds))) * (now - value_);
}

}  // namespace headway::detect
