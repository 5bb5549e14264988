#include "robot_driver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace headway::sim {

RobotDriver::RobotDriver(const RouteParams& route_params, double ride_deg, const Route& route,
                         std::uint64_t seed)
    : route_(route),
      lane_(besidePath(route.street, route.robot_left, false)),
      ride_rad_(ride_deg * M_PI / 180.0),
      random_(seed) {
  style_.wish_mps = route_params.speed_mps;
  style_.lateral = route_params.lateral_acceleration;
  at_.s = route.start_s;
  at_.speed = 0.8 * route_params.speed_mps;
  at_.length = 4.4;
  at_.width = 1.8;
}

void RobotDriver::ride(double dt, Wobble& wobble) {
  // A damped spring shaken by the road; stationary deviation `ride_rad_`.
  constexpr double kStiffness = 2.0 * M_PI * 1.2, kDamping = 0.35;  // [1/s], [-]
  const double shake = ride_rad_ * std::sqrt(4.0 * kDamping * std::pow(kStiffness, 3) / dt) *
                       std::min(1.0, at_.speed / 5.0);
  const double acceleration = -kStiffness * kStiffness * wobble.angle -
                              2.0 * kDamping * kStiffness * wobble.rate + shake * random_.normal();
  wobble.rate += dt * acceleration;
  wobble.angle += dt * wobble.rate;
}

void RobotDriver::advance(double dt, const std::vector<Obstacle>& others) {
  // Distances along the lane and along the street's middle differ in curves only, by little.
  const double bend = route_.street.curvature(at_.s);
  const double stretch = std::clamp(1.0 - bend * route_.robot_left, 0.5, 1.5);
  OnPath in_lane = at_;
  const Eigen::Vector2d here = route_.street.beside(at_.s, route_.robot_left).head<2>();
  in_lane.s = lane_.project(here, at_.s * 0.9 - 40.0, at_.s * 1.1 + 40.0).s;
  const double acceleration = drive(in_lane, lane_, style_, others, state().body.id,
                                    std::numeric_limits<double>::infinity());
  at_.speed = std::max(0.0, at_.speed + acceleration * dt);
  at_.s += at_.speed * dt / stretch;
  ride(dt, pitch_);
  ride(dt, roll_);
}

Pose RobotDriver::T_world_robot() const {
  const double s = at_.s;
  const PathPoint street = route_.street.at(s);
  const double rise =
      route_.street.at(s + 1.5).position.z() - route_.street.at(s - 1.5).position.z();
  Pose pose = Pose::Identity();
  pose.translation() = route_.street.beside(s, route_.robot_left);
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
  const PathPoint street = route_.street.at(at_.s);
  state.body.id = -2;
  state.body.position = route_.street.beside(at_.s, route_.robot_left).head<2>();
  state.body.yaw = street.yaw;
  state.body.velocity = at_.speed * Eigen::Vector2d(std::cos(street.yaw), std::sin(street.yaw));
  state.body.length = at_.length;
  state.body.width = at_.width;
  return state;
}

}  // namespace headway::sim
