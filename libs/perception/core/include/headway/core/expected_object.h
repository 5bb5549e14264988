// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>
#include <headway/core/ids.h>

#include <memory>

namespace headway {

/// An object that the tracker expects to be visible, as a plain value for detectors to search for.
///
/// A detector that finds it names `track` in Detection::searched_track; whether the detection
/// continues that track is up to the tracker.
struct ExpectedObject {
  TrackId track;
  ObjectClass object_class = ObjectClass::kUnknown;
  Time time = 0.0;                                     ///< of `position` [s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< box centre, map frame [m]
  MeasuredVelocity velocity;                ///< map frame, as a detector measured it last
  int observations = 0;                     ///< frames in which it was detected
  std::optional<std::int64_t> detector_id;  ///< of its last detection that had one
  Time last_observed = 0.0;                 ///< [s]
  Time last_motion = 0.0;  ///< when a detector last had evidence of motion over several frames [s]
  std::shared_ptr<const AppearanceTemplate> appearance;  ///< null: no template

  /// Where it will be if it keeps its velocity, map frame [m].
  [[nodiscard]] Eigen::Vector3d positionAt(Time then) const {
    return position + (then - time) * velocity.value;
  }
};

}  // namespace headway
