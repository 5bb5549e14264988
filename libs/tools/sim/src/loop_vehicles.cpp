// SPDX-License-Identifier: BSD-3-Clause
#include "loop_vehicles.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace headway::sim {

namespace {

/// The first place from `s` on from which a vehicle can brake for the robot; `s` if there is none.
double startClearOf(const Obstacle& robot, const Path& path, double s, double vehicle_length_m) {
  constexpr double kStep_m = 0.5, kBraking_m = 2.5;
  const double needed = 0.5 * (vehicle_length_m + robot.length) + kBraking_m;
  for (double ahead = 0.0; ahead < path.length(); ahead += kStep_m) {
    const double start = std::fmod(s + ahead, path.length());
    if ((path.at(start).position.head<2>() - robot.position).norm() > needed) return start;
  }
  return s;
}

}  // namespace

LoopVehicles::LoopVehicles(const TrafficParams& params, const Site& site, const Obstacle& robot,
                           std::uint64_t seed, std::int64_t& next_id)
    : random_(seed) {
  for (const bool cyclists : {true, false}) {
    std::vector<const VehicleLoop*> loops;
    for (const VehicleLoop& loop : site.loops) {
      if ((loop.kind == ActorKind::kCyclist) == cyclists) loops.push_back(&loop);
    }
    const int count = cyclists ? params.cyclists : params.vehicles;
    const double first = random_.uniform();
    for (int i = 0; i < count && !loops.empty(); ++i) {
      add(*loops[static_cast<std::size_t>(i) % loops.size()],
          first + static_cast<double>(i) / count, robot, next_id);
    }
  }
}

void LoopVehicles::add(const VehicleLoop& loop, double ratio, const Obstacle& robot,
                       std::int64_t& next_id) {
  Vehicle vehicle{Path(loop.points, true), {}, {}};
  Actor actor;
  actor.id = next_id++;
  actor.kind = loop.kind;
  actor.look = random_.below(100000);
  actor.size = drawSize(loop.kind, random_);
  vehicle.at.s = startClearOf(robot, vehicle.path, ratio * vehicle.path.length(), actor.size.x());
  vehicle.at.length = actor.size.x();
  vehicle.at.width = actor.size.y();
  vehicle.style.desired_speed_mps = loop.speed_mps * random_.uniform(0.85, 1.15);
  vehicle.style.standstill_m = 1.2;
  vehicle.style.headway_s = 0.8;
  vehicle.style.lateral = 1.2;
  vehicle.at.speed = 0.7 * vehicle.style.desired_speed_mps;
  vehicles_.push_back(vehicle);
  actors_.push_back(actor);
  place(vehicles_.size() - 1, 0.0);
}

void LoopVehicles::place(std::size_t i, double dt) {
  const Vehicle& vehicle = vehicles_[i];
  Actor& actor = actors_[i];
  const PathPoint point = vehicle.path.at(vehicle.at.s);
  // At corners the path is shorter than its parameter: the velocity is that of the motion.
  const Eigen::Vector3d step = point.position - actor.position;
  actor.position = point.position;
  actor.yaw = point.yaw;
  actor.speed = dt > 0.0 ? step.norm() / dt : vehicle.at.speed;
  actor.velocity = actor.speed * Eigen::Vector2d(std::cos(actor.yaw), std::sin(actor.yaw));
  if (actor.kind == ActorKind::kCyclist) actor.gait += 1.3 * actor.speed * dt;
}

void LoopVehicles::advance(double dt, const std::vector<Obstacle>& others) {
  std::vector<Obstacle> all = others;
  for (const Actor& actor : actors_) all.push_back(obstacleFrom(actor));
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    Vehicle& vehicle = vehicles_[i];
    const double acceleration = drive(vehicle.at, vehicle.path, vehicle.style, all, actors_[i].id,
                                      std::numeric_limits<double>::infinity());
    vehicle.at.speed = std::max(0.0, vehicle.at.speed + acceleration * dt);
    vehicle.at.s += vehicle.at.speed * dt;
    place(i, dt);
  }
}

}  // namespace headway::sim
