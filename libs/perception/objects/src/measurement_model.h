// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>
#include <headway/core/track.h>
#include <headway/objects/objects_params.h>

#include <vector>

#include "measured_box.h"

namespace headway::objects {

/// Transforms detections from the sensor's frame to the map and assigns their noise.
///
/// Reasons to drop a detection: low_score, unknown_class, no_3d_box, nan_box, zero_size,
/// behind_camera, too_far. A covariance that cannot be one is dropped without its box
/// (bad_covariance).
class MeasurementModel {
 public:
  MeasurementModel(const ConsistencyParams& selection, const FilterParams& noise)
      : selection_(selection), noise_(noise) {}

  /// @param dropped  counts the dropped detections by reason
  /// @return         in an order that does not depend on that of the detections
  [[nodiscard]] std::vector<MeasuredBox> toMap(const Pose& T_map_robot,
                                               const Detections& detections,
                                               DropCounts& dropped) const;

 private:
  /// Reason why a detection cannot be used; nullptr if it can.
  [[nodiscard]] const char* reasonToDrop(const Detection& detection) const;
  [[nodiscard]] MeasuredBox measured(const Pose& T_map_sensor, const Detection& detection) const;
  /// Noise of the heading [rad].
  [[nodiscard]] double yawSigma(const MeasuredBox& box) const;
  /// Noise of the centre along the viewing ray [m].
  [[nodiscard]] double sigmaAlong(const Box3d& box) const;
  [[nodiscard]] Eigen::Matrix3d centreCovariance(const Detection& detection) const;

  ConsistencyParams selection_;
  FilterParams noise_;
};

}  // namespace headway::objects
