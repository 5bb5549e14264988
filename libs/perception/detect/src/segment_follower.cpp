// SPDX-License-Identifier: BSD-3-Clause
// Upright segments followed from frame to frame, and the motion of each pooled from all that is
// known of it.
#include "segment_follower.h"

#include <headway/core/assignment.h>
#include <headway/core/statistics.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "point_motion.h"

namespace headway::detect {
namespace {

constexpr double kSegmentGate = 0.6;   // between a segment and its expected place [m]
constexpr double kEdgeRatio = 0.03;    // of its width: error of a segment's centre, and 0.5 px
constexpr double kRowSigma = 30.0;     // feet and heads are cut off at random [px]
constexpr double kMaxMissed_s = 0.35;  // three frames at 10 Hz; the next one at any rate
constexpr double kFlowTime_s = 0.55;   // of the flows kept of a segment, five at 10 Hz
constexpr std::size_t kMinFlows = 3;   // of these, at any rate: one may be a mismatch

double secondsOf(const std::deque<LateralSpeed>& flows) {
  double seconds = 0.0;
  for (const auto& flow : flows) seconds += flow.seconds;
  return seconds;
}

ObservationNoise noiseOf(const UprightSegment& segment) {
  return {0.5 + kEdgeRatio * segment.width_px, kRowSigma, kSurfaceSigma_px};
}

Eigen::Vector3d placeOf(const UprightSegment& segment, const CameraPath& path,
                        const StereoCamera& camera) {
  return path.T_cam_world(path.newest()).inverse() * *triangulate(segment.uvd, camera);
}

Eigen::Vector3d expectedPlace(const SegmentTrack& track, const CameraPath& path,
                              const Eigen::Vector3d& up) {
  if (!track.track.motion || track.track.observations.size() < 3) return track.last_place;
  return track.last_place + (path.timeOf(path.newest()) - path.timeOf(track.last_frame)) *
                                overGround(track.track.motion->velocity, up);
}

// Distance in units of the gate, which is longer along the line of sight: errors of disparity.
class Gate {
 public:
  Gate(const Eigen::Vector3d& expected, const CameraPath& path, const StereoCamera& camera,
       const Eigen::Vector3d& up)
      : expected_(expected), up_(up) {
    const Pose& T_cam_world = path.T_cam_world(path.newest());
    const double depth = (T_cam_world * expected).z();
    ray_ = overGround(expected - T_cam_world.inverse().translation(), up).normalized();
    across_ = kSegmentGate + kGatePerMetre * depth;
    along_ = across_ + depth * depth / (camera.fx * camera.baseline_m);  // 1 px of disparity
  }

  [[nodiscard]] double distanceOf(const Eigen::Vector3d& place) const {
    const Eigen::Vector3d off = overGround(place - expected_, up_);
    const double along = ray_.dot(off);
    return std::hypot(along / along_, (off - along * ray_).norm() / across_);
  }

 private:
  Eigen::Vector3d expected_, up_, ray_;
  double across_, along_;  ///< [m]
};

constexpr double kPartTail = 4.0;     // squared distance at which a part has half its weight
constexpr double kMedianLoss = 1.25;  // standard error of a median over that of a mean

// Velocity of one part over the ground: along the line of sight, and across it.
struct Part {
  Eigen::Vector2d velocity;
  Eigen::Matrix2d information;
};

// Axes over the ground: along the line of sight to the segment, and across it.
using Axes = Eigen::Matrix<double, 3, 2>;

Axes axesTo(const UprightSegment& segment, const CameraPath& path, const StereoCamera& camera,
            const Eigen::Vector3d& up) {
  const Eigen::Vector3d ray =
      path.T_cam_world(path.newest()).linear().transpose() * *triangulate(segment.uvd, camera);
  Axes axes;
  axes.col(0) = overGround(ray, up).normalized();
  axes.col(1) = up.cross(axes.col(0));
  return axes;
}

Part partOf(const PointMotion& motion, const Axes& axes, double scale) {
  const Eigen::Matrix2d covariance = axes.transpose() * motion.velocity_covariance * axes;
  return {axes.transpose() * motion.velocity, (scale * scale * covariance).inverse()};
}

// Median flow of some frames, its error estimated from their scatter. Along the line of sight it
// contributes the prior on walking speed alone.
Part partOf(const std::deque<LateralSpeed>& across, const Axes& axes, const Eigen::Vector3d& right,
            double speed_prior) {
  std::vector<double> speeds;
  std::vector<double> errors;
  for (const auto& flow : across) speeds.push_back(flow.speed);
  const double middle = median(speeds);
  for (const auto& flow : across) {
    errors.push_back(std::max(flow.sigma, std::abs(flow.speed - middle)));
  }
  const double sigma = kMedianLoss * median(errors);
  const double side = right.dot(axes.col(1)) < 0.0 ? -1.0 : 1.0;
  const double along = 1.0 / (speed_prior * speed_prior);
  const double information = static_cast<double>(across.size()) / (sigma * sigma);
  return {{0.0, side * middle}, Eigen::Vector2d(along, information).asDiagonal()};
}

// Robust mean.
struct Pooled {
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
};

Pooled pool(const std::vector<Part>& parts) {
  Pooled pooled;
  for (int i = 0; i < 5; ++i) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
    for (const auto& part : parts) {
      const Eigen::Vector2d off = part.velocity - pooled.velocity;
      const double squared = i == 0 ? 0.0 : off.dot(part.information * off);
      const Eigen::Matrix2d weighed = part.information / (1.0 + squared / kPartTail);
      information += weighed;
      sum += weighed * part.velocity;
    }
    pooled.information = information;
    pooled.velocity = information.ldlt().solve(sum);
  }
  return pooled;
}

// Of the camera, mean over its path [m/s].
double speedOf(const CameraPath& path) {
  const double seconds = path.timeOf(path.newest()) - path.timeOf(path.oldest());
  if (seconds <= 0.0) return 0.0;
  const Pose T = path.T_cam_world(path.newest()) * path.T_cam_world(path.oldest()).inverse();
  return T.translation().norm() / seconds;
}

// The parts of a segment and the time over which they were observed [s].
struct Parts {
  std::vector<Part> parts;
  double span = 0.0;

  void add(const Part& part, double seconds) {
    parts.push_back(part);
    span = std::max(span, seconds);
  }
};

// Every point on the segment that was followed for long enough.
void addPoints(const UprightSegment& segment, const std::vector<PointTrack>& points,
               const stereo::DisparityImage& disparity, const CameraPath& path,
               const StereoCamera& camera, const Axes& axes, const SegmentMotionParams& params,
               Parts& all) {
  cv::Mat inside(disparity.values.size(), CV_8U, cv::Scalar(0));
  for (const auto& cell : segment.cells) inside.at<unsigned char>(cell.place) = 1;
  const Time now = path.timeOf(path.newest());
  for (const auto& point : points) {
    const auto& uvd = point.observations.back().uvd;
    const cv::Point cell(disparity.cellOf(uvd.x()), disparity.cellOf(uvd.y()));
    const bool here =
        cv::Rect({0, 0}, inside.size()).contains(cell) && inside.at<unsigned char>(cell) != 0;
    if (!here || static_cast<int>(point.observations.size()) < params.min_observations) continue;
    const double seconds = now - path.timeOf(point.observations.front().frame);
    if (seconds < kMinSpan_s) continue;
    const auto motion =
        fitMotion(point.observations, path, camera, ObservationNoise(), params.speed_prior);
    if (!motion) continue;
    const double scale = std::max(params.noise_scale, std::sqrt(motion->movingFit()));
    all.add(partOf(*motion, axes, scale), seconds);
  }
}

// Covariance of the pooled velocity with the errors common to all parts.
Eigen::Matrix2d covarianceOf(const Pooled& pooled, const UprightSegment& segment, double span,
                             const CameraPath& path, const StereoCamera& camera,
                             const SegmentMotionParams& params) {
  const double depth = camera.fx * camera.baseline_m / segment.uvd.z();
  const double common_px2 =
      square(params.common_disparity_px / span) + square(params.drift_px) / span;
  const double along = std::sqrt(common_px2) * depth / segment.uvd.z();
  const double across = params.common_px * depth / camera.fx / span;
  const double slip = params.common_ratio * speedOf(path);
  Eigen::Matrix2d covariance = pooled.information.inverse();
  covariance.diagonal() +=
      Eigen::Vector2d(along * along + slip * slip, across * across + slip * slip);
  return covariance;
}

}  // namespace

void SegmentFollower::convert(const stereo::FrameContext& context) {
  if (!turn_change_.advance(context)) return;
  for (SegmentTrack& segment : tracks_) turn_change_.apply(segment.track.observations);
}

void SegmentFollower::follow(std::vector<UprightSegment> segments, const CameraPath& path,
                             const Eigen::Vector3d& up) {
  const auto ended = [&](const SegmentTrack& track) {
    return track.last_frame < path.oldest() ||
           (path.newest() - track.last_frame > 1 &&
            path.timeOf(path.newest()) - path.timeOf(track.last_frame) > kMaxMissed_s);
  };
  tracks_.erase(std::remove_if(tracks_.begin(), tracks_.end(), ended), tracks_.end());
  std::vector<CandidatePair> candidates;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const Gate gate(expectedPlace(tracks_[t], path, up), path, camera_, up);
    for (std::size_t b = 0; b < segments.size(); ++b) {
      const double off = gate.distanceOf(placeOf(segments[b], path, camera_));
      if (off < 1.0) candidates.push_back({t, b, off});
    }
  }
  std::vector<bool> taken(segments.size(), false);
  for (const auto& pair : assignPairs(std::move(candidates))) {
    extend(tracks_[pair.row], std::move(segments[pair.column]), path);
    taken[pair.column] = true;
  }
  for (std::size_t b = 0; b < segments.size(); ++b) {
    if (taken[b]) continue;
    SegmentTrack track;
    track.track.id = next_id_++;
    extend(track, std::move(segments[b]), path);
    tracks_.push_back(std::move(track));
  }
}

void SegmentFollower::extend(SegmentTrack& track, UprightSegment segment,
                             const CameraPath& path) const {
  auto& observations = track.track.observations;
  const auto old = [&](const Observation& observation) {
    return observation.frame < path.oldest();
  };
  observations.erase(observations.begin(),
                     std::find_if_not(observations.begin(), observations.end(), old));
  if (!segment.cut_by_flow) observations.push_back({path.newest(), segment.uvd});
  // Flows of the same images are one measurement.
  const Time now = path.timeOf(path.newest());
  if (segment.across && now - track.last_flow > 0.5 * segment.across->seconds) {
    track.across.push_back(*segment.across);
    track.last_flow = now;
  }
  while (track.across.size() > kMinFlows && secondsOf(track.across) > kFlowTime_s)
    track.across.pop_front();
  track.last_frame = path.newest();
  track.last_place = placeOf(segment, path, camera_);
  track.track.motion = fitMotion(observations, path, camera_, noiseOf(segment), 2.0);
  track.segment = std::move(segment);
}

std::optional<PointMotion> SegmentFollower::outlineMotion(const SegmentTrack& track) {
  const auto& motion = track.track.motion;
  if (!motion || motion->observations < kMinFitted) return std::nullopt;
  return motion->movingFit() < kGoodFit ? motion : std::nullopt;
}

bool areEnough(const std::deque<LateralSpeed>& flows, const SegmentMotionParams& params) {
  return static_cast<int>(flows.size()) >= params.min_flows &&
         secondsOf(flows) >= params.min_flow_time_s;
}

std::optional<SegmentMotion> segmentMotion(
    const UprightSegment& segment, const std::optional<PointMotion>& outline,
    const std::deque<LateralSpeed>& across, const std::vector<PointTrack>& points,
    const stereo::DisparityImage& disparity, const CameraPath& path, const StereoCamera& camera,
    const Eigen::Vector3d& up, const SegmentMotionParams& params) {
  const Axes axes = axesTo(segment, path, camera, up);
  Parts all;
  addPoints(segment, points, disparity, path, camera, axes, params, all);
  if (outline) all.add(partOf(*outline, axes, 1.0), kMinSpan_s);
  const bool flows = areEnough(across, params);
  if (flows) {
    const Eigen::Vector3d right = path.T_cam_world(path.newest()).linear().row(0);
    all.add(partOf(across, axes, right, params.speed_prior), secondsOf(across));
  }
  if (static_cast<int>(all.parts.size()) < params.min_parts && !flows) return std::nullopt;

  const Pooled pooled = pool(all.parts);
  const Eigen::Matrix2d covariance = covarianceOf(pooled, segment, all.span, path, camera, params);
  SegmentMotion motion;
  motion.velocity = axes * pooled.velocity;
  motion.covariance = axes * covariance * axes.transpose();
  motion.evidence = pooled.velocity.dot(covariance.inverse() * pooled.velocity);
  if (flows) {
    motion.across = std::abs(all.parts.back().velocity.y());
    motion.across_sigma = std::sqrt(covariance(1, 1));
  }
  motion.parts = static_cast<int>(all.parts.size());
  motion.span_s = all.span;
  return motion;
}

}  // namespace headway::detect
