// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <vector>

#include "point_classification.h"
#include "turn_change.h"
#include "upright_segments.h"

namespace headway::detect {

/// A segment followed from frame to frame by its centre.
struct SegmentTrack {
  PointTrack track;                 ///< its centres; `motion` fitted in each frame it is seen in
  UprightSegment segment;           ///< in the frame it was last seen in
  int last_frame = 0;               ///< it was last seen in
  std::deque<LateralSpeed> across;  ///< in frames in which its flow was measured, newest last
  Eigen::Vector3d last_place = Eigen::Vector3d::Zero();  ///< then, world of the path [m]
};

/// Follows segments of a person's size over a short window to measure their velocities.
///
/// Clothes often show no corners to follow, but the outline in the disparity image moves with the
/// person. A segment continues the track whose expected place is nearest. The outline of a partly
/// occluded segment moves with the occluder and is not used.
class SegmentFollower {
 public:
  explicit SegmentFollower(const StereoCamera& camera) : camera_(camera), turn_change_(camera) {}

  /// To disparities as they are measured in a new frame.
  void convert(const stereo::FrameContext& context);

  /// Associates the segments of a frame with the tracks and fits the motion of each.
  void follow(std::vector<UprightSegment> segments, const CameraPath& path,
              const Eigen::Vector3d& up);

  /// Motion of a track's outline; nullopt where it was occluded or seen in too few frames.
  [[nodiscard]] static std::optional<PointMotion> outlineMotion(const SegmentTrack& track);

  /// Whether a track's outline alone proves significant motion.
  ///
  /// @param window_s  in which it must have covered a minimum distance [s]
  [[nodiscard]] static bool moves(const SegmentTrack& track, const Eigen::Vector3d& up,
                                  const PointClassParams& params, double window_s);

  [[nodiscard]] std::vector<SegmentTrack>& tracks() { return tracks_; }
  void clear() { tracks_.clear(); }

 private:
  void extend(SegmentTrack& track, UprightSegment segment, const CameraPath& path) const;

  StereoCamera camera_;
  TurnChange turn_change_;
  std::vector<SegmentTrack> tracks_;
  std::int64_t next_id_ = 0;
};

}  // namespace headway::detect
