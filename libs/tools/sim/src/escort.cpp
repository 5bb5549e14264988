// SPDX-License-Identifier: BSD-3-Clause
#include "escort.h"

#include <headway/core/error.h>

#include <algorithm>
#include <cmath>

#include "covered_ratio.h"
#include "street_profile.h"

namespace headway::sim {
namespace {

using Profile = StreetProfile;

constexpr double kAheadClosest = 6.5;    // camera to the rear of a vehicle ahead [m]
constexpr double kPassingClosest = 3.0;  // camera to the rear of a passing vehicle [m]
constexpr double kCyclistClosest = 4.5;  // camera to the nearer cyclist [m]
constexpr double kFarthestBack = 28.0;   // largest distance behind [m]
constexpr double kSurge = 0.12;          // of the distance, to and fro

}  // namespace

Escort::Escort(const TrafficParams& params, const Route& route, const StereoCamera& camera,
               std::uint64_t seed, const RobotState& robot, const Pose& T_world_robot,
               std::int64_t& next_id)
    : params_(params), route_(route), camera_(camera), random_(seed) {
  if (params.image_share == 0.0) return;
  // Room to come closer when the robot sees little of them for a while.
  const double enough = std::min(1.25 * params.image_share, params.image_share + 0.08);
  const auto covers = [&](double ratio) {
    arrange(robot);
    return covered(T_world_robot, {}) >= ratio;
  };
  constexpr ActorKind kKinds[] = {ActorKind::kCar, ActorKind::kVan, ActorKind::kTruck,
                                  ActorKind::kBus};
  const bool ahead_first = random_.chance(0.5);
  for (const bool ahead : {ahead_first, !ahead_first}) {
    if (covers(enough)) return;
    recruit(kKinds[random_.below(4)], (ahead ? -1.0 : 1.0) * Profile::kLaneMiddle,
            ahead ? kAheadClosest : kPassingClosest, next_id);
  }
  for (const double closest : {kCyclistClosest, kCyclistClosest + 2.6}) {
    if (covers(enough)) return;
    recruit(ActorKind::kCyclist, -Profile::kCycling, closest, next_id);
  }
  for (const std::size_t i : {0U, 1U}) {
    if (covers(enough)) return;
    dress(i, ActorKind::kBus);
  }
  if (covers(params.image_share)) return;
  throw InputError("[traffic] image_share: " + std::to_string(params.image_share) +
                   " is more than vehicles around this camera can cover (about " +
                   std::to_string(covered(T_world_robot, {})) + ")");
}

void Escort::dress(std::size_t i, ActorKind kind) {
  actors_[i].kind = kind;
  actors_[i].size = drawSize(kind, random_);
  members_[i].lane.length = actors_[i].size.x();
  members_[i].lane.width = actors_[i].size.y();
}

void Escort::recruit(ActorKind kind, double left, double closest_m, std::int64_t& next_id) {
  members_.push_back({LaneKeeper(route_, left), closest_m, random_.uniform(6.0, 11.0),
                      random_.uniform(0.0, 2.0 * M_PI)});
  Actor actor;
  actor.id = next_id++;
  actor.look = random_.below(100000);
  actors_.push_back(actor);
  dress(actors_.size() - 1, kind);
}

TrafficParams Escort::others() const {
  TrafficParams others = params_;
  if (members_.empty()) return others;
  // The lanes are the escort's; cyclists come the other way.
  others.vehicles = 0;
  others.oncoming_ratio = 1.0;
  return others;
}

double Escort::slot(const Member& member) const {
  const double surge =
      1.0 + kSurge * std::sin(2.0 * M_PI * time_s_ / member.rhythm_s + member.phase);
  return std::min(member.closest_m * distance_ * surge, kFarthestBack);
}

void Escort::place(std::size_t i, double dt) {
  const LaneKeeper& lane = members_[i].lane;
  const PathPoint point = lane.place();
  Actor& actor = actors_[i];
  actor.position = point.position;
  actor.yaw = point.yaw;
  actor.speed = lane.speed;
  actor.velocity = lane.speed * Eigen::Vector2d(std::cos(point.yaw), std::sin(point.yaw));
  if (actor.kind == ActorKind::kCyclist) actor.gait += 1.3 * actor.speed * dt;
}

void Escort::arrange(const RobotState& robot) {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    LaneKeeper& lane = members_[i].lane;
    lane.s = robot.s + slot(members_[i]) + 0.5 * lane.length;
    lane.speed = robot.speed;
    place(i, 0.0);
  }
}

double Escort::covered(const Pose& T_world_robot, const std::vector<Actor>& others) const {
  std::vector<Actor> all = others;
  all.insert(all.end(), actors_.begin(), actors_.end());
  return coveredRatio(all, T_world_robot, camera_);
}

void Escort::populate(const RobotState& robot, const Pose& T_world_robot,
                      const std::vector<Actor>& others) {
  if (members_.empty()) return;
  double near = 1.0, far = kFarthestBack / kPassingClosest;
  for (int i = 0; i < 12; ++i) {  // bisection
    distance_ = 0.5 * (near + far);
    arrange(robot);
    (covered(T_world_robot, others) > params_.image_share ? near : far) = distance_;
  }
}

void Escort::advance(double dt, const RobotState& robot, const std::vector<Obstacle>& others) {
  time_s_ += dt;
  DriverStyle style;
  style.desired_speed_mps = 40.0;
  style.lateral = 4.0;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    LaneKeeper& lane = members_[i].lane;
    const double off = slot(members_[i]) - (lane.s - 0.5 * lane.length - robot.s);
    const double wanted = std::clamp(1.2 * off + 2.0 * (robot.speed - lane.speed), -6.0, 3.0);
    lane.move(dt, std::min(wanted, lane.acceleration(style, others, actors_[i].id)));
    place(i, dt);
  }
}

void Escort::observe(const Pose& T_world_robot, const std::vector<Actor>& others) {
  if (members_.empty()) return;
  constexpr double kMemory = 30.0;  // images in which a debt is paid back
  constexpr double kEagerness = 0.15;
  const double target = params_.image_share;
  const double now = covered(T_world_robot, others);
  images_ += 1.0;
  covered_sum_ += now;
  const double wanted =
      std::clamp(target + (target * images_ - covered_sum_) / kMemory, 0.3 * target, 0.9);
  distance_ *= std::pow(std::max(now, 0.01) / wanted, kEagerness);
  distance_ = std::clamp(distance_, 1.0, kFarthestBack / kPassingClosest);
}

}  // namespace headway::sim
