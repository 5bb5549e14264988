// SPDX-License-Identifier: BSD-3-Clause
#include "field_of_view.h"

#include <algorithm>
#include <cmath>

namespace headway::objects {

void FieldOfView::update(const Pose& T_map_sensor, const std::vector<MeasuredBox>& seen) {
  T_sensor_map_ = T_map_sensor.inverse();
  for (const MeasuredBox& box : seen) {
    const Eigen::Vector3d place = T_sensor_map_ * box.position;
    if (place.z() > 0.0) max_tangent_ = std::max(max_tangent_, std::abs(place.x()) / place.z());
  }
}

bool FieldOfView::covers(const Eigen::Vector3d& place) const {
  const Eigen::Vector3d seen = T_sensor_map_ * place;
  return seen.z() > 0.0 && std::abs(seen.x()) <= max_tangent_ * seen.z();
}

}  // namespace headway::objects
