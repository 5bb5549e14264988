#include <headway/nav/time_gate.h>
#include <mrpt/core/exceptions.h>

#include <algorithm>

namespace headway::nav {

TimeGate::TimeGate(const RobotMotionParams& robot) : robot_(robot) {
  ASSERTMSG_(robot.top_speed > 0.0 && robot.slow_share > 0.0,
             "the time gate needs a robot with positive speeds");
}

TimeSpan TimeGate::touching(double distance_m) const {
  const double slowest = robot_.top_speed * robot_.slow_share;
  const double free_way = std::max(0.0, distance_m - robot_.radius_m);
  return {free_way / robot_.top_speed - robot_.early_slack_s,
          (distance_m + robot_.radius_m) / slowest + robot_.late_slack_s};
}

}  // namespace headway::nav
