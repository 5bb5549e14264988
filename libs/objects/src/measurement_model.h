#pragma once

#include <headway/core/box_lifter.h>
#include <headway/core/track.h>
#include <headway/objects/objects_params.h>

#include <vector>

#include "measured_box.h"

namespace headway::objects {

/// Brings detections from the sensor's frame to the map, and says how well they are measured.
///
/// Reasons to leave a detection out: low_score, unknown_class, no_3d_box (and nothing to lift it
/// with), nan_box, zero_size, behind_camera, too_far.
class MeasurementModel {
 public:
  MeasurementModel(const ConsistencyParams& selection, const FilterParams& noise)
      : selection_(selection), noise_(noise) {}

  /// @param lifter   gives 2D boxes a depth; may be null
  /// @param dropped  counts what is left out, by reason
  /// @return         in an order that does not depend on that of the detections
  [[nodiscard]] std::vector<MeasuredBox> toMap(const Pose& T_map_robot,
                                               const Detections& detections,
                                               const BoxLifter* lifter, DropCounts& dropped) const;

 private:
  /// Why a detection cannot be used; nullptr if it can.
  [[nodiscard]] const char* reasonToDrop(const Detection& detection) const;
  [[nodiscard]] MeasuredBox measured(const Pose& T_map_sensor, const Detection& detection) const;
  [[nodiscard]] Eigen::Matrix3d centreCovariance(const Detection& detection) const;

  ConsistencyParams selection_;
  FilterParams noise_;
};

}  // namespace headway::objects
