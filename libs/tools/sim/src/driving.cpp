// SPDX-License-Identifier: BSD-3-Clause
// Drivers: how they follow paths and lanes, and brake for others.
#include "driving.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace headway::sim {
namespace {

constexpr double kLook = 50.0;  // drivers look this far ahead [m]

/// Intelligent driver model, eq. 1-3: free road, and approach to a leader.
double follow(double speed, double gap, double leader_speed, double desired,
              const DriverStyle& style) {
  const double free = 1.0 - std::pow(speed / std::max(0.1, desired), 4.0);
  if (!std::isfinite(gap)) return style.acceleration * free;
  const double closing = speed - leader_speed;
  const double wanted =
      style.standstill_m +
      std::max(0.0, speed * style.headway_s +
                        speed * closing /
                            (2.0 * std::sqrt(style.acceleration * style.comfortable_brake)));
  const double ratio = wanted / std::max(0.1, gap);
  return style.acceleration * (free - ratio * ratio);
}

/// Speed at which the curves ahead can be taken.
double curveSpeed(const OnPath& self, const Path& path, const DriverStyle& style) {
  double speed = style.desired_speed_mps;
  for (double ahead = 0.0; ahead <= 18.0; ahead += 3.0) {
    const double bend = std::abs(path.curvature(self.s + ahead));
    if (bend < 1e-4) continue;
    const double in_curve = std::sqrt(style.lateral / bend);
    // What can still be braked off until there.
    speed = std::min(speed,
                     std::sqrt(in_curve * in_curve + 2.0 * style.comfortable_brake * 0.6 * ahead));
  }
  return std::max(1.5, speed);
}

struct Leader {
  double gap = std::numeric_limits<double>::infinity();
  double speed = 0.0;
};

/// The obstacle as something to follow, if it is in the way or about to be.
Leader leaderFrom(const Obstacle& other, const OnPath& self, const Path& path) {
  const auto [s, left] = path.project(other.position, self.s, self.s + kLook);
  if (s <= self.s) return {};
  const double yaw = path.at(s).yaw;
  const double turn = other.yaw - yaw;
  const double c = std::abs(std::cos(turn)), n = std::abs(std::sin(turn));
  const double half_along = 0.5 * (c * other.length + n * other.width);
  const double half_across = 0.5 * (n * other.length + c * other.width);
  const Eigen::Vector2d along(std::cos(yaw), std::sin(yaw));
  const double across_speed = other.velocity.y() * along.x() - other.velocity.x() * along.y();
  double nearest_left = std::abs(left);
  if (other.on_foot || n > 0.5) {  // crossing: where it will be soon
    const double soon = left + 1.8 * across_speed;
    nearest_left = left * soon < 0.0 ? 0.0 : std::min(nearest_left, std::abs(soon));
  }
  const double margin = other.on_foot ? 0.6 : 0.25;
  if (nearest_left > 0.5 * self.width + half_across + margin) return {};
  return {s - self.s - 0.5 * self.length - half_along, std::max(0.0, other.velocity.dot(along))};
}

}  // namespace

Obstacle obstacleFrom(const Actor& actor) {
  return {actor.id,       actor.position.head<2>(), actor.velocity,      actor.yaw,
          actor.size.x(), actor.size.y(),           isPerson(actor.kind)};
}

std::vector<Obstacle> obstaclesFrom(const std::vector<Actor>& actors) {
  std::vector<Obstacle> obstacles;
  obstacles.reserve(actors.size());
  for (const Actor& actor : actors) obstacles.push_back(obstacleFrom(actor));
  return obstacles;
}

void placeOn(const PathPoint& point, double speed, double dt, Actor& actor) {
  actor.position = point.position;
  actor.yaw = point.yaw;
  actor.speed = speed;
  actor.velocity = speed * Eigen::Vector2d(std::cos(point.yaw), std::sin(point.yaw));
  if (actor.kind == ActorKind::kCyclist) actor.gait += 1.3 * speed * dt;
}

double drive(const OnPath& self, const Path& path, const DriverStyle& style,
             const std::vector<Obstacle>& others, std::int64_t own_id, double stop_s) {
  const Eigen::Vector2d here = path.at(self.s).position.head<2>();
  const double desired = curveSpeed(self, path, style);
  double acceleration =
      follow(self.speed, std::numeric_limits<double>::infinity(), 0.0, desired, style);
  for (const Obstacle& other : others) {
    if (other.id == own_id || (other.position - here).squaredNorm() > kLook * kLook) continue;
    const Leader leader = leaderFrom(other, self, path);
    if (!std::isfinite(leader.gap)) continue;
    acceleration =
        std::min(acceleration, follow(self.speed, leader.gap, leader.speed, desired, style));
  }
  if (std::isfinite(stop_s) && stop_s > self.s) {
    acceleration = std::min(
        acceleration,
        follow(self.speed, stop_s - self.s - 0.5 * self.length + 1.5, 0.0, desired, style));
  }
  return std::clamp(acceleration, -style.hardest_brake, style.acceleration);
}

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
