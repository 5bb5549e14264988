// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

#include <string>
#include <vector>

namespace headway {

/// A scan of a 2D laser, its beams taken at one time.
struct LaserScan {
  std::string label;                      ///< of the sensor
  Time time = 0.0;                        ///< [s]
  Pose T_robot_laser = Pose::Identity();  ///< the beams lie in the laser's xy plane
  double sigma_m = 0.02;                  ///< of a range [m]
  std::vector<Eigen::Vector2f> ends;      ///< of the beams with a valid range, laser frame [m]
};

}  // namespace headway
