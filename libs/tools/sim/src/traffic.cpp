// SPDX-License-Identifier: BSD-3-Clause
// All who move along the streets; the pedestrians among them.
#include "traffic.h"

#include <algorithm>
#include <cmath>

#include "route.h"

namespace headway::sim {
namespace {

/// Helbing & Molnar 1995, Sec. III, and what our pedestrians do beyond it.
struct SocialForce {
  double relaxation_s = 0.5;       ///< tau
  double repulsion = 2.1;          ///< V0 [m^2/s^2]
  double repulsion_reach_m = 0.3;  ///< sigma
  double personal_m = 0.45;        ///< two meshes side by side
  double patience_s = 20.0;        ///< at the kerb, then one walks on
};
constexpr SocialForce kForce{};

}  // namespace

Pedestrians::Pedestrians(const TrafficParams& params, const Route& route,
                         const RoadNetwork& network, std::uint64_t seed)
    : params_(params), route_(route), network_(network), random_(seed) {}

void Pedestrians::add(Person person, std::int64_t& next_id) {
  Actor actor = drawActor(ActorKind::kPedestrian, next_id++, random_);
  actor.gait = random_.uniform(0.0, 2.0 * M_PI);
  people_.push_back(person);
  actors_.push_back(actor);
  place(people_.size() - 1, 0.0);
}

void Pedestrians::drawIntent(Person& person) {
  const double pavement = random_.chance(0.5) ? 1.0 : -1.0;
  person.lane = pavement * random_.uniform(7.35, 8.5);
  person.direction = random_.chance(0.5) ? 1.0 : -1.0;
  person.desired_speed_mps =
      std::clamp(params_.walking_speed_mps + 0.26 * random_.normal(), 0.6, 2.2);
}

void Pedestrians::spawnGroup(const RobotState& robot, bool anywhere, int at_most,
                             std::int64_t& next_id) {
  Person person;
  const double nearest = anywhere ? 5.0 : 0.75 * params_.range_ahead_m;
  person.at.x() =
      robot.s + random_.uniform(nearest, std::max(nearest + 1.0, params_.range_ahead_m));
  if (!route_.street.closed() && person.at.x() > route_.street.length() - 5.0) return;
  drawIntent(person);
  person.at.y() = person.lane;
  const bool in_group = at_most > 1 && random_.chance(params_.group_ratio);
  const int size = in_group ? std::min(at_most, 2 + random_.below(2)) : 1;
  const std::int64_t leader = next_id;
  add(person, next_id);
  for (int k = 1; k < size; ++k) {
    Person member = person;
    member.leader = leader;
    member.offset = {0.25 * random_.normal(), (k == 1 ? 0.75 : -0.75) * (person.lane > 0 ? -1 : 1)};
    if (k == 2) member.offset.x() -= 0.8;
    member.at += member.offset;
    add(member, next_id);
  }
}

void Pedestrians::spawnBeforeCamera(const RobotState& robot, std::int64_t& next_id) {
  for (int k = 0; k < params_.in_front_at_start; ++k) {
    Person person;
    person.at = {robot.s + random_.uniform(6.0, 18.0), random_.uniform(-6.0, 4.5)};
    drawIntent(person);
    person.state = State::kCrossing;
    add(person, next_id);
  }
}

void Pedestrians::populate(const RobotState& robot, std::int64_t& next_id) {
  spawnBeforeCamera(robot, next_id);
  for (int tries = 0; tries < 1000; ++tries) {
    const int missing = params_.pedestrians - static_cast<int>(people_.size());
    if (missing <= 0) return;
    spawnGroup(robot, true, missing, next_id);
  }
}

const Pedestrians::Person* Pedestrians::find(std::int64_t id) const {
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    if (actors_[i].id == id) return &people_[i];
  }
  return nullptr;
}

bool Pedestrians::mayCross(const Person& person, const std::vector<Obstacle>& vehicles) const {
  // It takes some three seconds into the nearer lane; who has waited accepts less, and drivers
  // brake for the rest.
  const double gap = std::max(1.8, 3.2 - 0.25 * (kForce.patience_s - person.timer_s));
  const Eigen::Vector2d here = route_.street.beside(person.at.x(), 0.0).head<2>();
  return std::none_of(vehicles.begin(), vehicles.end(), [&](const Obstacle& vehicle) {
    const Eigen::Vector2d offset = here - vehicle.position;
    const double speed = vehicle.velocity.norm();
    if (offset.norm() < 6.0) return true;
    const double closing = offset.dot(vehicle.velocity) / offset.norm();
    return closing > 0.3 * speed && speed > 0.5 && offset.norm() / closing < gap;
  });
}

void Pedestrians::decide(Person& person, double dt, const std::vector<Obstacle>& vehicles) {
  switch (person.state) {
    case State::kWalking:
      if (random_.chance(params_.stop_rate_hz * dt)) {
        person.state = State::kStanding;
        person.timer_s = random_.uniform(1.5, 6.0);
      } else if (random_.chance(params_.road_crossing_rate_hz * dt)) {
        person.state = State::kWaiting;
        person.timer_s = kForce.patience_s;
      } else if (random_.chance(0.004 * dt)) {
        person.direction = -person.direction;
      }
      break;
    case State::kStanding:
      person.timer_s -= dt;
      if (person.timer_s <= 0.0) {
        person.state = State::kWalking;
        if (random_.chance(0.15)) person.direction = -person.direction;
      }
      break;
    case State::kWaiting:
      person.timer_s -= dt;
      if (person.timer_s <= 0.0) person.state = State::kWalking;
      if (std::abs(person.at.y()) < kStreet.carriageway + 0.55 && mayCross(person, vehicles)) {
        person.lane = -person.lane;
        person.state = State::kCrossing;
      }
      break;
    case State::kCrossing:
      if (std::abs(person.at.y() - person.lane) < 0.4) person.state = State::kWalking;
      break;
  }
}

Eigen::Vector2d Pedestrians::desiredVelocity(const Person& person) const {
  const double to_lane = person.lane - person.at.y();
  switch (person.state) {
    case State::kStanding:
      return Eigen::Vector2d::Zero();
    case State::kWaiting: {  // up to the kerb
      const double kerb = (person.lane > 0 ? 1.0 : -1.0) * (kStreet.carriageway + 0.4);
      return {0.0, std::clamp(kerb - person.at.y(), -1.0, 1.0)};
    }
    case State::kCrossing: {
      const double sign = to_lane > 0 ? 1.0 : -1.0;
      return 1.15 * person.desired_speed_mps *
             Eigen::Vector2d(0.15 * person.direction, sign).normalized();
    }
    case State::kWalking:
      break;
  }
  return {person.direction * person.desired_speed_mps, std::clamp(0.5 * to_lane, -0.5, 0.5)};
}

Eigen::Vector2d Pedestrians::repulsion(std::size_t i) const {
  Eigen::Vector2d force = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < people_.size(); ++k) {
    if (k == i) continue;
    Eigen::Vector2d away = people_[i].at - people_[k].at;
    // Where both will be in a moment counts, not where they are (elliptic form of the model).
    away += 0.6 * (people_[i].velocity - people_[k].velocity);
    const double distance = std::max(0.05, away.norm());
    if (distance > 3.0) continue;
    force += kForce.repulsion / kForce.repulsion_reach_m *
             std::exp((kForce.personal_m - distance) / kForce.repulsion_reach_m) * 0.5 * away /
             distance;
  }
  return force.norm() > 3.0 ? Eigen::Vector2d(3.0 * force.normalized()) : force;
}

double Pedestrians::groundAt(const Person& person) const {
  const double street = route_.street.at(person.at.x()).position.z();
  const double beyond_kerb = std::abs(person.at.y()) - kStreet.carriageway;
  double beside_junction = 10.0;
  for (const Road* road :
       network_.crossStreetsNear(person.at.x(), kStreet.carriageway + beside_junction)) {
    const double along = std::abs(route_.ahead(road->main_s, person.at.x()));
    beside_junction = std::min(beside_junction, along - kStreet.carriageway);
  }
  const double onto =
      std::clamp(std::min(beyond_kerb, beside_junction - 0.4) / 0.25 + 0.5, 0.0, 1.0);
  return street + onto * kStreet.kerb_height;
}

void Pedestrians::place(std::size_t i, double dt) {
  const Person& person = people_[i];
  Actor& actor = actors_[i];
  const PathPoint street = route_.street.at(person.at.x());
  actor.position = route_.street.beside(person.at.x(), person.at.y());
  actor.position.z() = groundAt(person);
  const double c = std::cos(street.yaw), s = std::sin(street.yaw);
  // Beside a bend the way is longer or shorter than the street's.
  constexpr double kReach = 0.1;  // [m]
  const double bend = std::remainder(
      route_.street.at(person.at.x() + kReach).yaw - route_.street.at(person.at.x() - kReach).yaw,
      2.0 * M_PI);
  const double along = (1.0 - person.at.y() * bend / (2.0 * kReach)) * person.velocity.x();
  actor.velocity = {c * along - s * person.velocity.y(), s * along + c * person.velocity.y()};
  actor.speed = actor.velocity.norm();
  if (dt == 0.0) {
    actor.yaw = street.yaw + (person.direction > 0 ? 0.0 : M_PI);
  } else if (actor.speed > 0.25) {
    const double wanted = std::atan2(actor.velocity.y(), actor.velocity.x());
    const double turn = std::remainder(wanted - actor.yaw, 2.0 * M_PI);
    actor.yaw += std::clamp(turn, -3.5 * dt, 3.5 * dt);
  }
  actor.yaw = std::remainder(actor.yaw, 2.0 * M_PI);
  swingLimbs(dt, actor);
}

void Pedestrians::retire(const RobotState& robot) {
  for (std::size_t i = people_.size(); i-- > 0;) {
    const double ahead = route_.ahead(robot.s, people_[i].at.x());
    if (ahead < -params_.range_behind_m || ahead > params_.range_ahead_m + 10.0) {
      people_.erase(people_.begin() + static_cast<long>(i));
      actors_.erase(actors_.begin() + static_cast<long>(i));
    }
  }
}

void Pedestrians::advance(double dt, const RobotState& robot, const std::vector<Obstacle>& vehicles,
                          std::int64_t& next_id) {
  std::vector<Eigen::Vector2d> forces;
  for (std::size_t i = 0; i < people_.size(); ++i) {
    Person& person = people_[i];
    const Person* leader = person.leader >= 0 ? find(person.leader) : nullptr;
    Eigen::Vector2d desired;
    if (leader != nullptr) {
      desired = leader->velocity + 0.9 * (leader->at + person.offset - person.at);
      if (desired.norm() > 2.2) desired *= 2.2 / desired.norm();
      person.lane = leader->lane + person.offset.y();
      person.direction = leader->direction;
      person.state = leader->state;
    } else {
      decide(person, dt, vehicles);
      desired = desiredVelocity(person);
    }
    forces.push_back((desired - person.velocity) / kForce.relaxation_s + repulsion(i));
  }
  for (std::size_t i = 0; i < people_.size(); ++i) {
    people_[i].velocity += dt * forces[i];
    people_[i].at += dt * people_[i].velocity;
    place(i, dt);
  }
  retire(robot);
  const int missing = params_.pedestrians - static_cast<int>(people_.size());
  if (missing > 0) spawnGroup(robot, false, missing, next_id);
}

namespace {

template <typename Item>
void append(const std::vector<Item>& more, std::vector<Item>& all) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

Traffic::Traffic(const SimParams& params, const Route& route, const RoadNetwork& network,
                 const StereoCamera& camera, const TrafficSeeds& seeds)
    : standing_(params.robot.standing),
      robot_(params.route, params.camera.ride_deg, params.traffic.image_share > 0.0, route,
             seeds.robot),
      escort_(params.traffic, route, camera, seeds.escort, robot_.state(), robot_.T_world_robot(),
              next_id_),
      vehicles_(escort_.others(), route, network, seeds.vehicles),
      pedestrians_(params.traffic, route, network, seeds.pedestrians) {
  if (standing_) robot_.halt();
  vehicles_.populate(robot_.state(), next_id_);
  pedestrians_.populate(robot_.state(), next_id_);
  escort_.populate(robot_.state(), robot_.T_world_robot(), others());
}

void Traffic::advance(double dt) {
  const RobotState robot = robot_.state();
  const auto on_foot = obstaclesFrom(pedestrians_.actors());
  const auto on_wheels = obstaclesFrom(vehicles_.actors());
  auto for_robot = on_foot;
  append(on_wheels, for_robot);
  escort_.advance(dt, robot, for_robot);
  const auto escort = obstaclesFrom(escort_.actors());
  append(escort, for_robot);
  auto for_vehicles = on_foot;
  for_vehicles.push_back(robot.obstacle);
  append(escort, for_vehicles);
  std::vector<Obstacle> for_pedestrians{robot.obstacle};
  append(on_wheels, for_pedestrians);
  append(escort, for_pedestrians);
  pedestrians_.advance(dt, robot, for_pedestrians, next_id_);
  vehicles_.advance(dt, robot, for_vehicles, next_id_);
  if (!standing_) robot_.advance(dt, for_robot);
}

std::vector<Actor> Traffic::others() const {
  std::vector<Actor> actors = vehicles_.actors();
  append(pedestrians_.actors(), actors);
  return actors;
}

std::vector<Actor> Traffic::actors() const {
  std::vector<Actor> actors = others();
  append(escort_.actors(), actors);
  return actors;
}

}  // namespace headway::sim
