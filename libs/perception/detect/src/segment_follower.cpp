// SPDX-License-Identifier: BSD-3-Clause
#include "segment_follower.h"

#include <headway/core/assignment.h>

#include <algorithm>
#include <cmath>

#include "over_ground.h"

namespace headway::detect {
namespace {

constexpr double kSegmentGate = 0.6;           // between a segment and its expected place [m]
constexpr double kSegmentGatePerMetre = 0.02;  // growth with depth [m/m]
constexpr double kGateDisparity = 1.0;  // and, along the line of sight, by this much disparity [px]
constexpr double kEdge = 0.5;           // error of a segment's centre [px]
constexpr double kEdgeRatio = 0.03;     // and ratio to its width
constexpr double kSegmentDisparitySigma = 0.3;  // [px]
constexpr double kRowSigma = 30.0;              // feet and heads are cut off at random [px]
constexpr double kMaxSpeed = 8.0;               // of a segment [m/s]
constexpr int kMinSegmentObservations = 4;
constexpr int kMaxMissed = 3;            // frames
constexpr double kGoodSegmentFit = 3.0;  // squared error to a degree of freedom
constexpr std::size_t kMaxFlows = 5;     // kept of a segment
constexpr double kMinTravel = 0.3;       // within the window [m]

ObservationNoise noiseOf(const UprightSegment& segment) {
  return {kEdge + kEdgeRatio * segment.width_px, kRowSigma, kSegmentDisparitySigma};
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
    across_ = kSegmentGate + kSegmentGatePerMetre * depth;
    along_ = across_ + kGateDisparity * depth * depth / (camera.fx * camera.baseline_m);
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

}  // namespace

void SegmentFollower::convert(const stereo::FrameContext& context) {
  if (!turn_change_.advance(context)) return;
  for (SegmentTrack& segment : tracks_) turn_change_.apply(segment.track.observations);
}

void SegmentFollower::follow(std::vector<UprightSegment> segments, const CameraPath& path,
                             const Eigen::Vector3d& up) {
  const auto ended = [&](const SegmentTrack& track) {
    return track.last_frame < path.oldest() || path.newest() - track.last_frame > kMaxMissed;
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
  if (!segment.hidden) observations.push_back({path.newest(), segment.uvd});
  if (segment.across) track.across.push_back(*segment.across);
  if (track.across.size() > kMaxFlows) track.across.pop_front();
  track.last_frame = path.newest();
  track.last_place = placeOf(segment, path, camera_);
  track.track.motion = fitMotion(observations, path, camera_, noiseOf(segment), 2.0);
  track.segment = std::move(segment);
}

std::optional<PointMotion> SegmentFollower::outlineMotion(const SegmentTrack& track) {
  const auto& motion = track.track.motion;
  if (!motion || motion->observations < kMinSegmentObservations) return std::nullopt;
  return motion->movingFit() < kGoodSegmentFit ? motion : std::nullopt;
}

bool SegmentFollower::moves(const SegmentTrack& track, const Eigen::Vector3d& up,
                            const PointClassParams& params, double window_s) {
  if (!track.track.motion) return false;
  PointClassParams strict = params;
  strict.min_observations = kMinSegmentObservations;
  strict.max_speed = kMaxSpeed;
  if (classifyPoint(track.track, up, strict) != PointClass::kMoving) return false;
  return overGround(track.track.motion->velocity, up).norm() * window_s > kMinTravel;
}

}  // namespace headway::detect
