// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

namespace headway {

/// A position measured by a satellite receiver.
struct GnssFix {
  Time time = 0.0;                                    ///< [s]
  Eigen::Vector3d antenna = Eigen::Vector3d::Zero();  ///< robot frame [m]
  double latitude_deg = 0.0;                          ///< WGS 84, north positive
  double longitude_deg = 0.0;                         ///< WGS 84, east positive
  double altitude_m = 0.0;                            ///< above the ellipsoid
  double sigma_m = 1.0;                               ///< of each horizontal axis
};

}  // namespace headway
