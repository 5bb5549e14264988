// SPDX-License-Identifier: BSD-3-Clause
// Frame-to-frame visual odometry without a map, which moves the odometry frame.
#include "visual_odometry.h"

#include <headway/core/statistics.h>
#include <headway/stereo/rectification.h>

#include <algorithm>
#include <set>
#include <utility>

#include "landmark_tracker.h"
#include "rigid_motions.h"

namespace headway::slam {
namespace {

/// How the offset of the disparities is estimated from corners that are lost.
struct OffsetParams {
  double followed_sigma_px = 1.0;  ///< of a corner's place after many frames, by drift of KLT
  double max_sigma_px = 0.5;       ///< of an expected disparity that tells the offset
  double max_residual = 3.0;       ///< of the evidence [standard deviations]
  std::size_t corners = 200;       ///< for an estimate: a line needs near and far ones
};
constexpr OffsetParams kOffset;
constexpr int kCorners = 250;          ///< cells of the image, each with a corner
constexpr double kRenewRatio = 0.9;    ///< of the corners, below which new ones are sought
constexpr double kMinDisparity = 0.1;  ///< [px]; nearer to 0 a depth has no upper bound
constexpr double kAgreement = 2.0;     ///< of where both motions see the corners [sigma_px]
constexpr stereo::PoseRefinerOptions kFromPrediction{8.0, 4, 5};
/// What a motion by descriptors must show.
struct WideStepParams {
  int features = 1000;            ///< of an image, as ORB-SLAM (Mur-Artal & Tardos 2015) takes
  double max_error_px = 3.0;      ///< ORB keypoints of the third octave are good to that
  int tries = 1000;               ///< finds 3 right ones of a fifth that are right with 0.999
  double log10_chance = -6.0;     ///< expected number of such motions by chance
  double min_stereo_ratio = 0.5;  ///< of its features whose disparity agrees: it took no part
  double max_turn_sigma = 0.006;  ///< of its rotation [rad]: a third of a degree
};
constexpr WideStepParams kWideStep;
constexpr stereo::PoseRefinerOptions kFromFeatures{2.0, 2, 6};

/// Logarithm of the expected number of motions by chance that `agreeing` of `matches` agree with.
double log10Chance(int agreeing, int matches, const StereoCamera& camera) {
  constexpr int kSample = 3;  ///< matches that determine a motion
  const auto choose = [](double n, double k) {
    return (std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0)) / M_LN10;
  };
  const double hit = M_PI * square(kWideStep.max_error_px) / (camera.width * camera.height);
  return std::log10(std::max(1, matches - kSample)) + choose(matches, agreeing) +
         choose(agreeing, kSample) + (agreeing - kSample) * std::log10(hit);
}

/// The tracked motion is right to a pixel; what differs by more moves on its own.
constexpr stereo::PoseRefinerOptions kNearTracked{2.0, 2, 6};

}  // namespace

VisualOdometry::VisualOdometry(const StereoCamera& camera, const SlamParams& params)
    : camera_(camera),
      params_(params),
      matcher_(matcherFor(camera, params)),
      grid_(camera.width, camera.height, kCorners) {}

std::optional<Pose> VisualOdometry::propose(const TrackingFrame& frame, const Pose& predicted) {
  followed_ = follow(frame, predicted);
  refine(predicted, kFromPrediction, followed_);
  return followed_.motion;
}

std::optional<Pose> VisualOdometry::proposeWide(const TrackingFrame& frame) {
  const auto step = stepByDescriptors(frame);
  if (!step) return std::nullopt;
  const PoseCovariance covariance = step_covariance_;
  followed_ = follow(frame, *step);
  refine(*step, kNearTracked, followed_);
  if (!followed_.motion) {
    step_covariance_ = covariance;
    followed_ = {};  // its corners would be those that do not agree
    followed_.motion = step;
  }
  followed_.by_features = true;
  return followed_.motion;
}

std::optional<Pose> VisualOdometry::advance(const TrackingFrame& frame,
                                            const std::optional<Pose>& tracked) {
  if (corners_.empty() && !followed_.motion) {
    restart(frame);
    return std::nullopt;
  }
  Followed followed = std::exchange(followed_, {});
  if (tracked && (!followed.motion || followed.by_features || !agree(followed, *tracked))) {
    Followed near_tracked = follow(frame, *tracked);
    removeOtherwiseMoving(*tracked, near_tracked);
    refine(*tracked, kNearTracked, near_tracked);
    // A motion that no corners agree with is that of a map that has just been adjusted.
    if (near_tracked.motion || !followed.motion || followed.by_features)
      followed = std::move(near_tracked);
  }
  const std::vector<Corner> before = std::exchange(corners_, cornersOf(followed));
  addEvidence(before);
  if (followed.motion) T_start_cam_ = normalized(T_start_cam_ * *followed.motion);
  estimateOffset();
  replenish(frame);
  return followed.motion;
}

/// The motion from the last frame by ORB features of both on all levels, which need no prediction.
std::optional<Pose> VisualOdometry::stepByDescriptors(const TrackingFrame& frame) {
  if (left_.levels.empty()) return std::nullopt;
  const auto featuresIn = [](const stereo::ImagePyramid& image, const cv::Mat& excluded) {
    return detectAndDescribe(image.levels.front(), kWideStep.features, excluded);
  };
  if (features_.empty()) features_ = featuresIn(left_, {});
  new_features_ = featuresIn(frame.left, frame.excluded);
  const auto& before = features_;
  const auto& now = new_features_;
  std::vector<stereo::PoseConstraint> constraints;
  for (const auto& [i, j] : matchDescriptors(descriptorsOf(before), descriptorsOf(now))) {
    const Eigen::Vector2d& uv = before[static_cast<std::size_t>(i)].uv;
    const auto disparity = matcher_.search(left_, right_, uv);
    if (!disparity || *disparity - offset_px_ < kMinDisparity) continue;
    stereo::PoseConstraint constraint;
    constraint.point_map = *triangulate({uv.x(), uv.y(), *disparity - offset_px_}, camera_);
    constraint.measurement.uv = now[static_cast<std::size_t>(j)].uv;
    constraint.measurement.sigma_px = 1.0;
    constraints.push_back(constraint);
  }
  const auto found = poseByConsensus(constraints, camera_, params_.min_inliers / 2,
                                     kWideStep.max_error_px, kWideStep.tries);
  if (!found) return std::nullopt;
  const auto matches = static_cast<int>(constraints.size());
  if (log10Chance(found->inliers, matches, camera_) > kWideStep.log10_chance) return std::nullopt;
  auto refined = stereo::refinePose(found->T_map_cam, constraints, camera_, kFromFeatures);
  if (!refined) return std::nullopt;
  int measured = 0;
  std::vector<stereo::PoseConstraint> agreeing;
  for (stereo::PoseConstraint& constraint : constraints) {
    const auto uvd =
        project(refined->T_map_cam.inverse(Eigen::Isometry) * constraint.point_map, camera_);
    if (!constraint.inlier || !uvd) continue;
    stereo::StereoMeasurement& seen = constraint.measurement;
    const auto disparity = matcher_.search(frame.left, frame.right, seen.uv);
    seen.stereo = disparity.has_value();
    seen.disparity = disparity.value_or(0.0) - offset_px_;
    seen.sigma_disparity_px = 2.0 * params_.sigma_disparity_px;  // of two frames
    measured += seen.stereo ? 1 : 0;
    agreeing.push_back(constraint);
  }
  refined = stereo::refinePose(refined->T_map_cam, agreeing, camera_, kFromFeatures);
  if (!refined || refined->inliers < params_.min_inliers / 2) return std::nullopt;
  const auto in_stereo = std::count_if(agreeing.begin(), agreeing.end(), [](const auto& one) {
    return one.inlier && one.measurement.stereo && one.stereo_inlier;
  });
  if (log10Chance(refined->inliers, matches, camera_) > kWideStep.log10_chance ||
      static_cast<double>(in_stereo) <= kWideStep.min_stereo_ratio * measured ||
      rotationSigma(refined->covariance) >= kWideStep.max_turn_sigma) {
    return std::nullopt;
  }
  step_covariance_ = refined->covariance;
  return refined->T_map_cam;
}

void VisualOdometry::restart(const TrackingFrame& frame) {
  corners_.clear();
  followed_ = {};
  replenish(frame);
}

VisualOdometry::Followed VisualOdometry::follow(const TrackingFrame& frame,
                                                const Pose& expected) const {
  const Pose T_current_previous = expected.inverse(Eigen::Isometry);
  std::vector<Eigen::Vector2d> before, predicted;
  std::vector<Eigen::Vector3d> points;
  std::vector<Corner> corners;
  std::vector<double> expected_px;
  for (const Corner& corner : corners_) {
    const auto point = triangulate({corner.uv.x(), corner.uv.y(), corner.disparity_px}, camera_);
    const auto uvd = point ? project(T_current_previous * *point, camera_) : std::nullopt;
    if (!uvd) continue;
    before.push_back(corner.uv);
    predicted.emplace_back(uvd->head<2>());
    points.push_back(*point);
    corners.push_back(corner);
    expected_px.push_back(uvd->z() + offset_px_);
  }
  const auto found = followPoints(left_, frame, before, predicted);
  Followed followed;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!found[i]) continue;
    const auto disparity = matcher_.refine(frame.left, frame.right, *found[i], expected_px[i], 0);
    const stereo::StereoMeasurement measured{*found[i], disparity.value_or(0.0) - offset_px_,
                                             disparity.has_value(), params_.sigma_px,
                                             params_.sigma_disparity_px};
    followed.constraints.push_back({points[i], measured, true, true});
    followed.before.push_back(corners[i]);
  }
  return followed;
}

/// The majority may be an object: the minority that moves as the camera must not be outvoted.
void VisualOdometry::removeOtherwiseMoving(const Pose& tracked, Followed& followed) const {
  (void)stereo::markInliers(tracked, followed.constraints, camera_, 1.0);
  Followed same;
  for (std::size_t i = 0; i < followed.constraints.size(); ++i) {
    if (!followed.constraints[i].inlier || !followed.constraints[i].stereo_inlier) continue;
    same.constraints.push_back(followed.constraints[i]);
    same.before.push_back(followed.before[i]);
  }
  followed = std::move(same);
}

void VisualOdometry::refine(const Pose& expected, const stereo::PoseRefinerOptions& gates,
                            Followed& followed) {
  const auto refined = stereo::refinePose(expected, followed.constraints, camera_, gates);
  if (!refined || refined->inliers < params_.min_inliers) return;
  followed.motion = refined->T_map_cam;
  step_covariance_ = refined->covariance;
}

/// Whether most corners are where the tracked motion sees them, too.
bool VisualOdometry::agree(const Followed& followed, const Pose& tracked) const {
  const Pose T_now_previous = followed.motion->inverse(Eigen::Isometry);
  const Pose T_tracked_previous = tracked.inverse(Eigen::Isometry);
  std::vector<double> apart;
  for (const auto& constraint : followed.constraints) {
    const auto here = project(T_now_previous * constraint.point_map, camera_);
    const auto there = project(T_tracked_previous * constraint.point_map, camera_);
    if (here && there) apart.push_back((*here - *there).head<2>().norm());
  }
  return !apart.empty() && median(apart) <= kAgreement * params_.sigma_px;
}

/// The corners that agree with the motion, in the new frame, their depths filtered.
std::vector<VisualOdometry::Corner> VisualOdometry::cornersOf(const Followed& followed) const {
  std::vector<Corner> corners;
  if (!followed.motion) return corners;
  const Pose T_now_previous = followed.motion->inverse(Eigen::Isometry);
  for (std::size_t i = 0; i < followed.constraints.size(); ++i) {
    const auto& [point, measured, inlier, stereo_inlier] = followed.constraints[i];
    const auto uvd = project(T_now_previous * point, camera_);
    if (!inlier || !uvd) continue;
    Corner corner = followed.before[i];
    corner.uv = measured.uv;
    corner.disparity_px = uvd->z();
    if (measured.stereo && stereo_inlier) {
      const double variance = measured.sigma_disparity_px * measured.sigma_disparity_px;
      const double gain = corner.variance_px2 / (corner.variance_px2 + variance);
      corner.disparity_px += gain * (measured.disparity - uvd->z());
      corner.variance_px2 *= 1.0 - gain;
    }
    corner.disparity_px = std::max(corner.disparity_px, kMinDisparity);
    corners.push_back(corner);
  }
  return corners;
}

/// Compares the disparities of corners that are lost with those by the camera's motion, in the
/// previous frame.
void VisualOdometry::addEvidence(const std::vector<Corner>& before) {
  std::set<std::pair<double, double>> kept;
  for (const Corner& corner : corners_) kept.emplace(corner.first_uv.x(), corner.first_uv.y());
  for (const Corner& corner : before) {
    if (kept.count({corner.first_uv.x(), corner.first_uv.y()}) > 0) continue;
    const Pose T_last_first = T_start_cam_.inverse(Eigen::Isometry) * corner.T_start_first;
    const auto ray = [&](const Eigen::Vector2d& uv) {
      return Eigen::Vector3d((uv.x() - camera_.cx) / camera_.fx, (uv.y() - camera_.cy) / camera_.fy,
                             1.0);
    };
    const Eigen::Vector3d turned = T_last_first.linear() * ray(corner.first_uv);
    const Eigen::Vector3d last = ray(corner.uv);
    const Eigen::Vector3d& t = T_last_first.translation();
    // The point is at (turned + inverse_depth * t) up to scale, and is seen along `last`.
    const Eigen::Vector2d parallax = last.head<2>() * t.z() - t.head<2>();
    const Eigen::Vector2d moved = turned.head<2>() - last.head<2>() * turned.z();
    const double inverse_depth = parallax.dot(moved) / parallax.squaredNorm();
    const double depth = turned.z() / inverse_depth + t.z();
    const double focal_baseline = camera_.fx * camera_.baseline_m;
    const double sigma_px = kOffset.followed_sigma_px * camera_.baseline_m / parallax.norm();
    if (!(inverse_depth > 0.0) || !(depth > 0.0) || !(sigma_px < kOffset.max_sigma_px)) continue;
    evidence_.push_back({corner.disparity_px + offset_px_, focal_baseline / depth,
                         corner.variance_px2, sigma_px * sigma_px});
  }
}

/// Fits a line to the evidence, twice, the second time without outliers.
void VisualOdometry::estimateOffset() {
  if (evidence_.size() < kOffset.corners) return;
  Line line{1.0, offset_px_, 0.0};
  for (const double gate : {5.0 * kOffset.max_residual, kOffset.max_residual}) {
    std::vector<Evidence> agreeing;
    for (const Evidence& one : evidence_) {
      const double residual = one.measured_px - line.slope * one.expected_px - line.offset_px;
      const double variance =
          one.measured_variance + line.slope * line.slope * one.expected_variance;
      if (residual * residual <= gate * gate * variance) agreeing.push_back(one);
    }
    const auto fitted = fitLine(agreeing);
    if (!fitted) return evidence_.clear();
    line = *fitted;
  }
  offset_record_.add({line.offset_px, std::sqrt(line.offset_variance)}, stereo::kIndependentRatio);
  offset_px_ = is_turned_ || offset_record_.isCorrected() ? offset_record_.estimate().px : 0.0;
  evidence_.clear();
}

/// Line through points with errors in both coordinates: by least squares of the measured
/// disparities alone the noise of the expected ones would make it too flat, and its offset too
/// great.
///
/// @see  York et al. 2004, "Unified equations for the slope, intercept, and standard errors of the
///       best straight line"
std::optional<VisualOdometry::Line> VisualOdometry::fitLine(const std::vector<Evidence>& points) {
  constexpr int kIterations = 20;
  Line line;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    double weights = 0.0, mean_x = 0.0, mean_y = 0.0;
    const auto weightOf = [slope = line.slope](const Evidence& at) {
      return 1.0 / (at.measured_variance + slope * slope * at.expected_variance);
    };
    for (const Evidence& at : points) {
      weights += weightOf(at);
      mean_x += weightOf(at) * at.expected_px;
      mean_y += weightOf(at) * at.measured_px;
    }
    mean_x /= weights;
    mean_y /= weights;
    double products = 0.0, squares = 0.0, sum = 0.0, sum_of_squares = 0.0;
    for (const Evidence& at : points) {
      const double w = weightOf(at);
      const double x = at.expected_px - mean_x;
      const double y = at.measured_px - mean_y;
      // Where the point truly is along the line, from its mean.
      const double along = w * (x * at.measured_variance + line.slope * y * at.expected_variance);
      products += w * along * y;
      squares += w * along * x;
      sum += w * along;
      sum_of_squares += w * along * along;
    }
    const double slope = products / squares;
    const double mean = sum / weights;
    const double slope_variance = 1.0 / (sum_of_squares - weights * mean * mean);
    if (!(slope > 0.5 && slope < 2.0) || !(slope_variance > 0.0)) return std::nullopt;
    line.slope = slope;
    line.offset_px = mean_y - slope * mean_x;
    line.offset_variance = 1.0 / weights + (mean_x + mean) * (mean_x + mean) * slope_variance;
  }
  return line;
}

/// The right images are turned back otherwise from now on: what was measured is converted.
void VisualOdometry::turnRightCamera(const Eigen::Vector3d& before, const Eigen::Vector3d& now) {
  if (before == now) return;
  // An offset that was estimated under another yaw is a part of it.
  const double offset = before.y() == now.y() ? offset_px_ : 0.0;
  for (Corner& corner : corners_) {
    const double measured = corner.disparity_px + offset_px_;
    corner.disparity_px = std::max(
        kMinDisparity, stereo::turnedDisparity(corner.uv, measured, before, now, camera_) - offset);
  }
  evidence_.clear();
  offset_px_ = offset;
  if (before.y() != now.y()) offset_record_ = {};
  is_turned_ = now.y() != 0.0;
}

/// Fills free cells with new corners, if a part of those that were there has been lost.
void VisualOdometry::replenish(const TrackingFrame& frame) {
  left_ = frame.left;
  right_ = frame.right;
  features_ = std::exchange(new_features_, {});
  if (static_cast<double>(corners_.size()) > kRenewRatio * static_cast<double>(most_corners_)) {
    return;
  }
  std::vector<bool> occupied(static_cast<std::size_t>(grid_.count()), false);
  for (const Corner& corner : corners_) {
    occupied[static_cast<std::size_t>(grid_.cellOf(corner.uv))] = true;
  }
  for (const Keypoint& keypoint :
       detectKeypoints(left_.levels.front(), grid_, occupied, frame.excluded)) {
    const auto disparity = matcher_.search(frame.left, frame.right, keypoint.uv);
    if (!disparity || *disparity - offset_px_ < kMinDisparity) continue;
    corners_.push_back({keypoint.uv, *disparity - offset_px_,
                        params_.sigma_disparity_px * params_.sigma_disparity_px, keypoint.uv,
                        T_start_cam_});
  }
  most_corners_ = corners_.size();
}

}  // namespace headway::slam
