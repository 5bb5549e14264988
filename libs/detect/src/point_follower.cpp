#include "point_follower.h"

#include <algorithm>
#include <cmath>
#include <opencv2/video/tracking.hpp>

#include "interest_points.h"

namespace headway::detect {
namespace {

const cv::Size kWindow(9, 9);
constexpr int kLevels = 3;                 // above the full image
constexpr double kMostWayBackError = 0.7;  // between a point and where the way back ends [px]
constexpr double kMostRowError = 1.0;      // between the rows in left and right image [px]
constexpr double kMostDenseError = 2.0;    // between point and dense disparity [px]
constexpr double kLeastDisparity = 1.0;    // [px]
constexpr float kMostGreyError = 18.0F;    // mean difference of the windows [grey levels]
constexpr double kLost = -1.0;

const cv::TermCriteria kStop(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 20, 0.02);

struct Flow {
  std::vector<cv::Point2f> places;
  std::vector<unsigned char> found;
};

const cv::Point2f kNowhere(-1.0F, -1.0F);

// Moves points from one picture to another, starting from where they are thought to be.
Flow flow(const std::vector<cv::Mat>& from, const std::vector<cv::Mat>& to,
          const std::vector<cv::Point2f>& points, std::vector<cv::Point2f> guesses, int levels) {
  Flow result;
  result.places = std::move(guesses);
  std::vector<float> errors;
  cv::calcOpticalFlowPyrLK(from, to, points, result.places, result.found, errors, kWindow, levels,
                           kStop, cv::OPTFLOW_USE_INITIAL_FLOW, 1e-3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (errors[i] > kMostGreyError) result.found[i] = 0;
  }
  return result;
}

// Finds points in the next image; kNowhere for those that are not found, or elsewhere on the way
// back.
std::vector<cv::Point2f> followed(const std::vector<cv::Mat>& before,
                                  const std::vector<cv::Mat>& after,
                                  const std::vector<cv::Point2f>& points,
                                  const std::vector<cv::Point2f>& guesses) {
  if (points.empty()) return {};
  Flow there = flow(before, after, points, guesses, kLevels);
  const Flow back = flow(after, before, there.places, points, 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Point2f off = back.places[i] - points[i];
    const bool returned = back.found[i] != 0 && std::hypot(off.x, off.y) < kMostWayBackError;
    if (there.found[i] == 0 || !returned) there.places[i] = kNowhere;
  }
  return std::move(there.places);
}

}  // namespace

void PointFollower::clear() {
  points_.clear();
  left_before_.clear();
  left_.clear();
  right_.clear();
}

Eigen::Vector3d PointFollower::expectedAt(const PointTrack& point, const CameraPath& path) const {
  const Sighting& last = point.sightings.back();
  const auto in_cam = triangulate(last.uvd, camera_);
  Eigen::Vector3d in_world = path.T_cam_world(last.frame).inverse() * *in_cam;
  if (point.motion && point.group >= 0) {
    in_world += (path.timeOf(path.newest()) - path.timeOf(last.frame)) * point.motion->velocity;
  }
  return project(path.T_cam_world(path.newest()) * in_world, camera_).value_or(last.uvd);
}

void PointFollower::follow(const StereoFrame& frame, const stereo::DisparityImage& disparity,
                           const CameraPath& path) {
  std::swap(left_before_, left_);
  cv::buildOpticalFlowPyramid(frame.left, left_, kWindow, kLevels);
  cv::buildOpticalFlowPyramid(frame.right, right_, kWindow, 1, false);
  if (left_before_.empty() || points_.empty()) return;

  std::vector<cv::Point2f> before;
  std::vector<cv::Point2f> guesses;
  std::vector<double> expected_disparities;
  for (const auto& point : points_) {
    const auto& uvd = point.sightings.back().uvd;
    const Eigen::Vector3d expected = expectedAt(point, path);
    before.emplace_back(static_cast<float>(uvd.x()), static_cast<float>(uvd.y()));
    guesses.emplace_back(static_cast<float>(expected.x()), static_cast<float>(expected.y()));
    expected_disparities.push_back(expected.z());
  }
  auto places = followed(left_before_, left_, before, guesses);
  seekWhereTheyWere(before, places);
  keepFound(places, disparitiesOf(places, expected_disparities, disparity), path);
}

// What moves along with the camera is far from where a still world would put it.
void PointFollower::seekWhereTheyWere(const std::vector<cv::Point2f>& before,
                                      std::vector<cv::Point2f>& places) const {
  std::vector<std::size_t> lost;
  std::vector<cv::Point2f> from;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] != kNowhere) continue;
    lost.push_back(i);
    from.push_back(before[i]);
  }
  const auto found = followed(left_before_, left_, from, from);
  for (std::size_t i = 0; i < lost.size(); ++i) places[lost[i]] = found[i];
}

std::vector<double> PointFollower::disparitiesOf(const std::vector<cv::Point2f>& places,
                                                 const std::vector<double>& guesses,
                                                 const stereo::DisparityImage& disparity) const {
  std::vector<double> result(places.size(), kLost);
  if (places.empty()) return result;
  std::vector<double> dense(places.size());
  std::vector<cv::Point2f> right_guesses;
  for (std::size_t i = 0; i < places.size(); ++i) {
    dense[i] = disparity.at(places[i].x, places[i].y);
    const double guess = dense[i] > 0.0 ? dense[i] : guesses[i];
    right_guesses.emplace_back(places[i].x - static_cast<float>(guess + offset_), places[i].y);
  }
  const Flow right = flow(left_, right_, places, right_guesses, 1);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double d = places[i].x - right.places[i].x - offset_;
    const bool level = std::abs(places[i].y - right.places[i].y) < kMostRowError;
    const bool agrees = dense[i] <= 0.0 || std::abs(d - dense[i]) < kMostDenseError;
    if (right.found[i] != 0 && places[i].x >= 0.0F && level && agrees && d > kLeastDisparity) {
      result[i] = d;
    }
  }
  return result;
}

void PointFollower::keepFound(const std::vector<cv::Point2f>& places,
                              const std::vector<double>& disparities, const CameraPath& path) {
  std::vector<PointTrack> kept;
  kept.reserve(points_.size());
  const Time now = path.timeOf(path.newest());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const cv::Point2f& place = places[i];
    const bool inside = place.x >= 0.0F && place.y >= 0.0F && place.x < camera_.width - 1.0 &&
                        place.y < camera_.height - 1.0;
    if (!inside || disparities[i] == kLost) continue;
    PointTrack point = std::move(points_[i]);
    point.sightings.push_back({path.newest(), {place.x, place.y, disparities[i]}});
    const auto old = [&](const Sighting& sighting) {
      return sighting.frame < path.oldest() ||
             path.timeOf(sighting.frame) < now - params_.window_s - 1e-6;
    };
    point.sightings.erase(point.sightings.begin(),
                          std::find_if_not(point.sightings.begin(), point.sightings.end(), old));
    kept.push_back(std::move(point));
  }
  points_ = std::move(kept);
}

void PointFollower::replenish(const StereoFrame& frame, const stereo::DisparityImage& disparity,
                              const std::optional<stereo::GroundPlane>& ground, int frame_number) {
  if (left_.empty()) return;
  std::vector<cv::Point2f> taken;
  for (const auto& point : points_) {
    const auto& uvd = point.sightings.back().uvd;
    taken.emplace_back(static_cast<float>(uvd.x()), static_cast<float>(uvd.y()));
  }
  const int wanted = params_.max_points - static_cast<int>(points_.size());
  const InterestZone zone{params_.range_m, params_.least_height_m, params_.most_height_m};
  const auto chosen = interestPoints(frame.left, disparity, camera_, ground, zone, taken,
                                     params_.spacing_px, wanted);
  std::vector<double> guesses;
  guesses.reserve(chosen.size());
  for (const auto& place : chosen) guesses.push_back(disparity.at(place.x, place.y));
  const auto disparities = disparitiesOf(chosen, guesses, disparity);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (disparities[i] == kLost) continue;
    PointTrack point;
    point.id = next_id_++;
    point.sightings.push_back({frame_number, {chosen[i].x, chosen[i].y, disparities[i]}});
    points_.push_back(std::move(point));
  }
}

}  // namespace headway::detect
