#include "lane_keeper.h"

#include <algorithm>
#include <limits>

namespace headway::sim {

LaneKeeper::LaneKeeper(const Route& route, double left)
    : route_(route), left_(left), lane_(besidePath(route.street, left, false)) {}

double LaneKeeper::acceleration(const DriverStyle& style, const std::vector<Obstacle>& others,
                                std::int64_t own_id) const {
  // Distances along the lane and along the street's middle differ in curves only, by little.
  const Eigen::Vector2d here = route_.street.beside(s, left_).head<2>();
  const double in_lane = lane_.project(here, s * 0.9 - 40.0, s * 1.1 + 40.0).s;
  return drive({in_lane, speed, length, width}, lane_, style, others, own_id,
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
