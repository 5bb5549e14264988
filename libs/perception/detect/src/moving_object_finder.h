// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/detect/stereo_motion.h>

#include <vector>

#include "motion_frame.h"
#include "moving_object.h"

namespace headway::detect {

/// Parameters of point classification, from those of the detector.
[[nodiscard]] PointClassParams pointClassParams(const StereoMotionParams& params);

/// Finds moving objects in a frame by motion alone: clusters of points that move alike, and
/// segments that move as a whole. Clusters and segments that overlap are merged to one object.
class MovingObjectFinder {
 public:
  MovingObjectFinder(const StereoCamera& camera, const StereoMotionParams& params)
      : camera_(camera), params_(params) {}

  /// @param segments  followed; the objects found point into them
  [[nodiscard]] std::vector<MovingObject> find(const MotionFrame& frame,
                                               std::vector<SegmentTrack>& segments);

  /// Number of objects rejected since the last call: too small, off the ground, or among static
  /// points.
  [[nodiscard]] std::size_t takeImplausible();

 private:
  void addClusters(const MotionFrame& frame, std::vector<MovingObject>& objects);
  void addSegments(const MotionFrame& frame, std::vector<SegmentTrack>& segments,
                   std::vector<MovingObject>& objects);
  [[nodiscard]] std::optional<MeasuredVelocity> velocityOf(const SegmentTrack& segment,
                                                           const MotionFrame& frame) const;
  [[nodiscard]] std::optional<ObjectExtent> plausibleExtent(const std::vector<ObjectCell>& cells,
                                                            const MeasuredVelocity& velocity,
                                                            const stereo::GroundPlane& floor,
                                                            double min_ratio,
                                                            const MotionFrame& frame);

  StereoCamera camera_;
  StereoMotionParams params_;
  std::size_t implausible_ = 0;
};

}  // namespace headway::detect
