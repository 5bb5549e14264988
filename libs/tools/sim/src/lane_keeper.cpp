// SPDX-License-Identifier: BSD-3-Clause
#include "lane_keeper.h"

#include <algorithm>
#include <limits>

namespace headway::sim {

LaneKeeper::LaneKeeper(const Route& route, double left)
    : route_(route), left_(left), lane_(besidePath(route.street, left, false)) {}

double LaneKeeper::alongLane() {
  const Eigen::Vector2d here = route_.street.beside(s, left_).head<2>();
  double expected = s, reach = 0.1 * s + 40.0;
  if (found_) {
    expected = found_->second + s - found_->first;
    reach = 20.0;
  }
  const double lane_s = lane_.project(here, expected - reach, expected + reach).s;
  found_.emplace(s, lane_s);
  return lane_s;
}

double LaneKeeper::acceleration(const DriverStyle& style, const std::vector<Obstacle>& others,
                                std::int64_t own_id) {
  return drive({alongLane(), speed, length, width}, lane_, style, others, own_id,
               std::numeric_limits<double>::infinity());
}

void LaneKeeper::move(double dt, double acceleration) {
  const double stretch = std::clamp(1.0 - route_.street.curvature(s) * left_, 0.5, 1.5);
  speed = std::max(0.0, speed + acceleration * dt);
  s += speed * dt / stretch;
}

PathPoint LaneKeeper::place() const {
  return {route_.street.beside(s, left_), route_.street.at(s).yaw};
}

}  // namespace headway::sim
