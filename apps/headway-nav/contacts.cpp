// SPDX-License-Identifier: BSD-3-Clause
// Whose fault a contact is: rules of counting the collisions and near misses of a drive.
#include "contacts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace headway::app {
namespace {

using Eigen::Vector2d;

constexpr double kBrake = 2.5;       // of people who stop: the simulated walkers' limit [m/s^2]
constexpr double kNearMiss_m = 0.3;  // as the figures state them
constexpr double kMoves_mps = 0.02;  // slower wheels are at rest
constexpr double kTurns_radps = 0.05;
constexpr double kBumpPause_s = 1.0;  // a robot that pushes against a thing bumps into it once

Vector2d clampedTo(const sim::Footprint& box, const Vector2d& point) {
  const Eigen::Rotation2Dd turn(box.yaw);
  const Vector2d local = turn.inverse() * (point - box.centre), half = 0.5 * box.size;
  return box.centre + turn * local.cwiseMax(-half).cwiseMin(half);
}

bool moves(const sim::DriveCommand& motion) {
  return std::abs(motion.speed) > kMoves_mps || std::abs(motion.turn_rate) > kTurns_radps;
}

const sim::Footprint& nearestTo(const sim::Footprint& body,
                                const std::vector<sim::Footprint>& shapes) {
  return *std::min_element(shapes.begin(), shapes.end(), [&](const auto& a, const auto& b) {
    return gapBetween(body, a) < gapBetween(body, b);
  });
}

}  // namespace

sim::Footprint brakingZone(const sim::Footprint& part, const Vector2d& velocity) {
  const double speed = velocity.norm();
  const double distance = speed * speed / (2.0 * kBrake);
  if (distance < 1e-6) return part;
  const Vector2d along = velocity / speed;
  const double yaw = std::atan2(along.y(), along.x());
  // Of a shape that is not a point, the rectangle along the motion that encloses it.
  const double turn = part.yaw - yaw;
  const Vector2d& size = part.size;
  const Vector2d extent(std::abs(std::cos(turn)) * size.x() + std::abs(std::sin(turn)) * size.y(),
                        std::abs(std::sin(turn)) * size.x() + std::abs(std::cos(turn)) * size.y());
  return {part.centre + 0.5 * distance * along, extent + Vector2d(distance, 0.0), yaw};
}

double approachSpeed(const sim::DrivenRobot& robot, const Vector2d& size,
                     const sim::Footprint& shape) {
  const sim::Footprint body{robot.position, size, robot.yaw};
  // Nearest points of both; two projections suffice for shapes that are small beside their gap or
  // touch.
  const Vector2d on_shape = clampedTo(shape, robot.position);
  const Vector2d on_robot = clampedTo(body, on_shape);
  Vector2d towards = on_shape - on_robot;
  if (towards.norm() < 1e-6) towards = shape.centre - robot.position;
  if (towards.norm() < 1e-6) return 0.0;
  const Vector2d lever = on_robot - robot.position;
  const Vector2d velocity =
      robot.motion.speed * Vector2d(std::cos(robot.yaw), std::sin(robot.yaw)) +
      robot.motion.turn_rate * Vector2d(-lever.y(), lever.x());
  return velocity.dot(towards.normalized());
}

void ContactCounter::observe(const sim::DrivenRobot& robot, const std::vector<sim::Mover>& movers,
                             double dt) {
  touches_ = false;
  for (const sim::Mover& mover : movers) meet(robot, mover, encounters_[mover.id]);
  since_bump_s_ += dt;
  if (!robot.bumped) return;
  touches_ = true;
  if (since_bump_s_ > kBumpPause_s) ++counts_.with_things;
  since_bump_s_ = 0.0;
}

void ContactCounter::meet(const sim::DrivenRobot& robot, const sim::Mover& mover,
                          Encounter& encounter) {
  const sim::Footprint body{robot.position, size_, robot.yaw};
  std::vector<sim::Footprint> zones;
  for (const auto& part : mover.parts) zones.push_back(brakingZone(part, mover.velocity));
  const sim::Footprint& zone = nearestTo(body, zones);
  const sim::Footprint& part = nearestTo(body, mover.parts);
  const double gap = std::max(0.0, gapBetween(body, part) - mover.radius_m);
  counts_.min_distance_m = std::min(counts_.min_distance_m, gap);
  if (gapBetween(body, zone) > mover.radius_m) {
    encounter.intruded = false;
  } else if (approachSpeed(robot, size_, zone) > kMoves_mps) {
    encounter.intruded = true;
  }
  const bool touches = gap <= 0.0;
  touches_ = touches_ || touches;
  if (touches && !encounter.touches) {
    const bool approaches = approachSpeed(robot, size_, part) > kMoves_mps;
    ++(encounter.intruded || approaches ? counts_.by_robot : counts_.by_others);
  }
  encounter.touches = touches;
  const bool is_near = gap < kNearMiss_m;
  if (is_near && !encounter.is_near) encounter.touched = encounter.moved = false;
  encounter.touched = encounter.touched || touches;
  encounter.moved = encounter.moved || (is_near && moves(robot.motion));
  const bool is_over = encounter.is_near && !is_near;
  if (is_over && encounter.moved && !encounter.touched) ++counts_.near_misses;
  encounter.is_near = is_near;
}

}  // namespace headway::app
