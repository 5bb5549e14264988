// SPDX-License-Identifier: BSD-3-Clause
#include "field_of_view.h"

#include <algorithm>
#include <cmath>

namespace headway::objects {

void FieldOfView::widenTo(const Eigen::Vector3d& place) {
  const Eigen::Vector3d seen = inSensor(place);
  if (seen.z() > 0.0) max_tangent_ = std::max(max_tangent_, std::abs(seen.x()) / seen.z());
}

bool FieldOfView::covers(const Eigen::Vector3d& place) const {
  const Eigen::Vector3d seen = inSensor(place);
  return seen.z() > 0.0 && std::abs(seen.x()) <= max_tangent_ * seen.z();
}

}  // namespace headway::objects
