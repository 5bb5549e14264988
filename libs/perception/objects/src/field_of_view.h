// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

namespace headway::objects {

/// Field of view of the detector, estimated from the largest bearing at which it has followed an
/// object: a false detection beside it does not widen it.
///
/// An undetected object outside of it is not a missed detection.
class FieldOfView {
 public:
  /// Sets the pose of the sensor.
  void move(const Pose& T_map_sensor) { T_sensor_map_ = T_map_sensor.inverse(); }

  /// Widens the field of view to where a confirmed object was detected, in the map.
  void widenTo(const Eigen::Vector3d& place);

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
