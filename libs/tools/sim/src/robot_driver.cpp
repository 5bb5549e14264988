// SPDX-License-Identifier: BSD-3-Clause
#include "robot_driver.h"

#include <algorithm>
#include <cmath>

namespace headway::sim {
namespace {}  // namespace

RobotDriver::RobotDriver(const RouteParams& route_params, double ride_deg, bool close_up,
                         const Route& route, std::uint64_t seed)
    : route_(route),
      at_(route, route.robot_left),
      ride_rad_(ride_deg * M_PI / 180.0),
      random_(seed) {
  style_.desired_speed_mps = route_params.speed_mps;
  style_.lateral = route_params.lateral_acceleration_mps2;
  if (close_up) {
    style_.headway_s = 0.4;
    style_.standstill_m = 1.5;
  }
  at_.s = route.start_s;
  at_.speed = 0.8 * route_params.speed_mps;
  at_.length = 4.4;
  at_.width = 1.8;
}

void RobotDriver::advance(double dt, const std::vector<Obstacle>& others) {
  at_.move(dt, at_.acceleration(style_, others, kRobotId));
  const double motion = std::min(1.0, at_.speed / 5.0);
  pitch_.advance(dt, ride_rad_, motion, 0.0, random_);
  roll_.advance(dt, ride_rad_, motion, 0.0, random_);
}

Pose RobotDriver::T_world_robot() const {
  const double s = at_.s;
  const PathPoint street = route_.street.at(s);
  const double rise =
      route_.street.at(s + 1.5).position.z() - route_.street.at(s - 1.5).position.z();
  Pose pose = Pose::Identity();
  pose.translation() = at_.place().position;
  pose.linear() =
      (Eigen::AngleAxisd(street.yaw, Eigen::Vector3d::UnitZ()) *
       Eigen::AngleAxisd(-std::atan2(rise, 3.0) + pitch_.angle, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(roll_.angle, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  return pose;
}

RobotState RobotDriver::state() const {
  RobotState state;
  state.s = at_.s;
  state.speed = at_.speed;
  const PathPoint place = at_.place();
  state.obstacle.id = kRobotId;
  state.obstacle.position = place.position.head<2>();
  state.obstacle.yaw = place.yaw;
  state.obstacle.velocity = at_.speed * Eigen::Vector2d(std::cos(place.yaw), std::sin(place.yaw));
  state.obstacle.length = at_.length;
  state.obstacle.width = at_.width;
  return state;
}

}  // namespace headway::sim
