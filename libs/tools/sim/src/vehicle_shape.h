// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "actor.h"

namespace headway::sim {

/// Outline of a vehicle's side: ratios of its length (from the rear) and of its height.
struct OutlinePoint {
  double x = 0.0;
  double z = 0.0;
};

/// What makes a vehicle of one kind: outline of its top, and where its wheels are.
struct VehicleShape {
  std::vector<OutlinePoint> outline;  ///< from the rear to the front
  double floor = 0.18;                ///< lower edge of the body, ratio of the height
  double belt = 0.6;                  ///< below it the body is straight, above it leans inwards
  double lean = 0.8;                  ///< width at the top, ratio of the full width
  double rear_wheel = 0.19;           ///< ratio of the length
  double front_wheel = 0.8;
  double wheel_radius_m = 0.32;
};

/// @param look  cars come as saloon, hatchback and estate
[[nodiscard]] const VehicleShape& shapeOf(ActorKind kind, int look);

}  // namespace headway::sim
