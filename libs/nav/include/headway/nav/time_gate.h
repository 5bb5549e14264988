#pragma once

#include <headway/nav/predictive_obstacles_params.h>

namespace headway::nav {

/// A span of time from now on [s].
struct TimeSpan {
  double from_s = 0.0;
  double to_s = 0.0;

  [[nodiscard]] bool overlaps(const TimeSpan& other) const {
    return from_s <= other.to_s && other.from_s <= to_s;
  }
};

/// When the robot could touch a point that is somewhere.
///
/// The robot drives straight there, at any speed from its slowest to its maximum speed: it touches
/// the point at the earliest after the free way between them at maximum speed, and has passed it at
/// the latest after the way beyond it at the slowest. Laws: a farther point is touched later; a
/// wider range of speeds, or more slack, gives a longer span; a point under the robot is touched
/// now.
///
/// Bodies need no more than points: two bodies that meet touch first with points of their edges.
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
