#pragma once

#include <headway/core/pose.h>

#include <vector>

#include "measured_box.h"

namespace headway::objects {

/// Where the detector can see anything at all, learnt from what it has seen.
///
/// An object that leaves the view is not missing: nobody looked there.
class FieldOfView {
 public:
  /// Takes in where the sensor is now and what it sees.
  void look(const Pose& T_map_sensor, const std::vector<MeasuredBox>& seen);

  /// Whether a place in the map lies ahead, no farther aside than anything seen so far.
  [[nodiscard]] bool covers(const Eigen::Vector3d& place) const;

  /// A place of the map in the sensor's optical frame [m].
  [[nodiscard]] Eigen::Vector3d inSensor(const Eigen::Vector3d& place) const {
    return T_sensor_map_ * place;
  }

 private:
  Pose T_sensor_map_ = Pose::Identity();
  double widest_ = 0.0;  ///< tangent of the largest bearing seen
};

}  // namespace headway::objects
