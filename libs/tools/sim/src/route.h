// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/sim/sim_params.h>

#include <cmath>

#include "path.h"

namespace headway::sim {

/// The street that the robot drives along: its middle line, and the part that is driven.
struct Route {
  Path street;           ///< goes on beyond both ends of an open drive, so that the view is filled
  double start_s = 0.0;  ///< [m]
  double end_s = 0.0;    ///< [m]; of a closed street beyond its length if there are several laps
  double robot_left = 0.0;  ///< where the robot drives, to the left of the middle line [m]

  /// Way from one place on the street to another; the shorter way round a closed one [m].
  [[nodiscard]] double ahead(double from, double to) const {
    return street.closed() ? std::remainder(to - from, street.length()) : to - from;
  }
};

/// @throws InputError naming the key of a shape or file that cannot be used
[[nodiscard]] Route makeRoute(const RouteParams& params, double hill_height_m);

}  // namespace headway::sim
