// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>

#include <optional>
#include <vector>

#include "object_extent.h"
#include "segment_follower.h"

namespace headway::detect {

/// A moving object as detected in one frame.
struct MovingObject {
  ObjectExtent extent;
  MeasuredVelocity velocity;            ///< over the ground, world of the path
  int first_frame = 0;                  ///< the velocity was measured since then
  int points = 0;                       ///< observations that support it
  std::vector<std::size_t> members;     ///< indices of points that move with it
  std::vector<SegmentTrack*> segments;  ///< that belong to it
  DetectionEvidence evidence;
  std::int64_t group = -1;                ///< that its points and segments belong to
  std::optional<TrackId> searched_track;  ///< that it was searched for
};

constexpr double kMinAcross = 0.3;  ///< of a segment detected by flow alone [m/s]

/// Whether an extent overlaps an object in the image at its depth, or on the ground.
[[nodiscard]] bool isPartOf(const ObjectExtent& part, const MovingObject& object);

/// Whether it is part of any of them.
[[nodiscard]] bool isPartOfAny(const ObjectExtent& part, const std::vector<MovingObject>& objects);

/// Whether two velocities are similar enough for parts of one object.
[[nodiscard]] bool isAsFast(const Eigen::Vector3d& velocity, const Eigen::Vector3d& other);

/// Whether two velocities are opposite, so that they belong to different objects.
[[nodiscard]] bool isOpposite(const Eigen::Vector3d& velocity, const Eigen::Vector3d& other);

}  // namespace headway::detect
