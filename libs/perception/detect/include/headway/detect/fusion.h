// SPDX-License-Identifier: BSD-3-Clause
// Joins what several detectors found in one frame.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/track.h>

#include <vector>

namespace headway::detect {

/// When two detectors mean the same object.
struct FusionParams {
  double same_iou = 0.4;         ///< of the 2D boxes [-]
  double same_inside = 0.7;      ///< or ratio of one 2D box inside the other [-]
  double same_distance_m = 1.5;  ///< between the centres over the ground, where both have any [m]
  /// A Pedestrian by a classifier that is a Cyclist by its motion is a Cyclist: a bicycle is easily
  /// hidden, and pedestrians are slower.
  bool rider_by_motion = false;
};

/// What fuse() makes of several sources.
struct FusedDetections {
  Detections detections;  ///< time and sensor of the first source; no source: empty
  /// "part_of_other": of an object that another detection of the same source was joined to, such as
  /// one half of it.
  DropCounts dropped;
};

/// Joins what several detectors found in one frame, without doubles.
///
/// Two detections of different sources are one object if their image boxes overlap and, where both
/// have a place in space, those are near to each other; without image boxes the places decide. The
/// earlier source's detection is kept (list the one that knows classes first) and takes from the
/// other what it lacks: the 3D box with its covariance, the 2D box, or the velocity. A class that
/// is Unknown gives way to a known one. Laws: one source alone comes out as it went in; nothing is
/// invented; every detection is in the result, joined to one in it, or counted as dropped.
///
/// @param sources  of the same frame and sensor, best informed first
[[nodiscard]] FusedDetections fuse(const std::vector<Detections>& sources,
                                   const FusionParams& params = {});

}  // namespace headway::detect
