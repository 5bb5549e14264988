// SPDX-License-Identifier: BSD-3-Clause
// Upright segments followed from frame to frame, and the motion of each pooled from all that is
// known of it.
#pragma once

#include <headway/core/detection.h>

#include <deque>
#include <limits>
#include <optional>
#include <vector>

#include "disparity_drift.h"
#include "point_follower.h"
#include "point_motion.h"
#include "upright_segments.h"

namespace headway::detect {

inline constexpr double kMaxSegmentSpeed = 8.0;  ///< [m/s]

/// A segment followed from frame to frame by its centre.
struct SegmentTrack {
  PointTrack track;                 ///< its centres; `motion` fitted in each frame it is seen in
  UprightSegment segment;           ///< in the frame it was last seen in
  int last_frame = 0;               ///< it was last seen in
  std::deque<LateralSpeed> across;  ///< its flows of different images, newest last
  Time last_flow = -std::numeric_limits<double>::infinity();  ///< end of the newest of these
  Eigen::Vector3d last_place = Eigen::Vector3d::Zero();       ///< then, world of the path [m]
};

/// Follows segments of a person's size over a short window to measure their velocities.
///
/// Clothes often show no corners to follow, but the outline in the disparity image moves with the
/// person. A segment continues the track whose expected place is nearest. The outline of a segment
/// that its flow alone separates ends where the flow does, and is not used.
class SegmentFollower {
 public:
  explicit SegmentFollower(const StereoCamera& camera) : camera_(camera), turn_change_(camera) {}

  /// To disparities as they are measured in a new frame.
  void convert(const stereo::FrameContext& context);

  /// Associates the segments of a frame with the tracks and fits the motion of each.
  void follow(std::vector<UprightSegment> segments, const CameraPath& path,
              const Eigen::Vector3d& up);

  /// Motion of a track's outline; nullopt where it was seen in too few frames.
  [[nodiscard]] static std::optional<PointMotion> outlineMotion(const SegmentTrack& track);

  [[nodiscard]] std::vector<SegmentTrack>& tracks() { return tracks_; }
  void clear() { tracks_.clear(); }

 private:
  void extend(SegmentTrack& track, UprightSegment segment, const CameraPath& path) const;

  StereoCamera camera_;
  TurnChange turn_change_;
  std::vector<SegmentTrack> tracks_;
  std::int64_t next_id_ = 0;
};

/// Motion of a segment as a whole, estimated from everything followed on it.
struct SegmentMotion {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< over the ground, world of the path [m/s]
  Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Identity();  ///< errors common to all parts included
  double evidence = 0.0;            ///< of motion: chi-square of 2 degrees of freedom if static
  int parts = 0;                    ///< it was estimated from
  double span_s = 0.0;              ///< over which these were observed
  double across = 0.0;  ///< speed across the line of sight by flow alone; 0: not measured [m/s]
  double across_sigma = 0.0;  ///< [m/s]
};

/// Parameters of segmentMotion().
struct SegmentMotionParams {
  int min_observations = kMinFitted;
  int min_parts = 3;
  int min_flows = 2;              ///< a single one may be a mismatch
  double min_flow_time_s = 0.15;  ///< that they cover together: two at 10 Hz [s]
  double noise_scale = 1.0;       ///< true errors of observations over those assumed [-]
  double speed_prior = 3.0;       ///< standard deviation of a segment's speed [m/s]
  double common_px = 0.3;         ///< drift of the camera's direction over the observations [px]
  double common_ratio = 0.01;     ///< errors of calibration and motion, of the camera's speed [-]
  double common_disparity_px = kCommonDisparity_px;  ///< drift of a segment's disparity [px]
  double drift_px = 0.0;  ///< more of it, measured, in a second: see DisparityDrift [px]
};

/// Whether flows are enough to be part of a segment's motion.
[[nodiscard]] bool areEnough(const std::deque<LateralSpeed>& flows,
                             const SegmentMotionParams& params);

/// Pools the velocities of the parts of a segment: the points followed on it, its outline and flow.
///
/// The motion of each point of a person who walks along the line of sight is within its error;
/// pooled over all points it is significant. All points are used however they move, so the mean is
/// unbiased; limbs and background are down-weighted (Cauchy). Errors common to all parts, of the
/// camera's motion and of stereo, are added once and do not average out.
///
/// @param outline  motion of the segment's outline, where it was followed
/// @param across   speeds by flow in the last frames
/// @param up       unit normal of the ground, in the world of the path
/// @return         nullopt for too few parts
[[nodiscard]] std::optional<SegmentMotion> segmentMotion(
    const UprightSegment& segment, const std::optional<PointMotion>& outline,
    const std::deque<LateralSpeed>& across, const std::vector<PointTrack>& points,
    const stereo::DisparityImage& disparity, const CameraPath& path, const StereoCamera& camera,
    const Eigen::Vector3d& up, const SegmentMotionParams& params);

}  // namespace headway::detect
