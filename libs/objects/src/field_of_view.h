// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

#include <vector>

#include "measured_box.h"

namespace headway::objects {

/// Field of view of the detector, estimated from the largest bearing of its detections.
///
/// An undetected object outside of it is not a missed detection.
class FieldOfView {
 public:
  /// Updates the pose of the sensor and widens the field of view to its detections.
  void update(const Pose& T_map_sensor, const std::vector<MeasuredBox>& seen);

  /// Whether a position in the map is in front, within the largest bearing so far.
  [[nodiscard]] bool covers(const Eigen::Vector3d& place) const;

  /// A position of the map in the sensor's optical frame [m].
  [[nodiscard]] Eigen::Vector3d inSensor(const Eigen::Vector3d& place) const {
    return T_sensor_map_ * place;
  }

 private:
  Pose T_sensor_map_ = Pose::Identity();
  double max_tangent_ = 0.0;  ///< tangent of the largest bearing so far
};

}  // namespace headway::objects
