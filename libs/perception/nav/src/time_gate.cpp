// SPDX-License-Identifier: BSD-3-Clause
#include <headway/nav/time_gate.h>

#include <algorithm>

namespace headway::nav {

TimeGate::TimeGate(const RobotMotionParams& robot) : robot_(validated(robot)) {}

TimeSpan TimeGate::touching(double distance_m) const {
  const double slowest = robot_.max_speed_mps * robot_.slow_ratio;
  const double free_way = std::max(0.0, distance_m - robot_.radius_m);
  return {free_way / robot_.max_speed_mps - robot_.early_slack_s,
          (distance_m + robot_.radius_m) / slowest + robot_.late_slack_s};
}

}  // namespace headway::nav
