// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/nav/predictive_obstacles_params.h>

namespace headway::nav {

/// A span of time, relative to now [s].
struct TimeSpan {
  double from_s = 0.0;
  double to_s = 0.0;

  [[nodiscard]] bool overlaps(const TimeSpan& other) const {
    return from_s <= other.to_s && other.from_s <= to_s;
  }
};

/// Time span in which the robot could touch a point.
///
/// The robot is assumed to drive straight to the point at any speed between its lowest and its
/// maximum speed: it touches the point at the earliest after the free distance at maximum speed,
/// and has passed it at the latest after the distance beyond it at the lowest speed. Laws: a
/// farther point is touched later; a wider range of speeds, or more slack, gives a longer span; a
/// point under the robot is touched now. Points suffice, because two shapes first touch at points
/// of their edges.
class TimeGate {
 public:
  /// @throws InputError if a parameter is out of range
  explicit TimeGate(const RobotMotionParams& robot);

  /// @param distance_m  from the robot's origin to the point
  [[nodiscard]] TimeSpan touching(double distance_m) const;

 private:
  RobotMotionParams robot_;
};

}  // namespace headway::nav
