// SPDX-License-Identifier: BSD-3-Clause
// Vehicles on the streets, and those that escort the robot.
#include "vehicles.h"

#include <headway/core/error.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh_projection.h"
#include "route.h"

namespace headway::sim {
namespace {

constexpr double kPathReach = 320.0;  // of a path made along the street [m]

/// The lane `left` of the street's middle from street_s on, in driving direction.
std::vector<Eigen::Vector3d> lanePoints(const Path& street, double street_s, double left,
                                        bool backwards, double length) {
  std::vector<Eigen::Vector3d> points;
  for (double d = 0.0; d <= length; d += 1.0) {
    const double s = backwards ? street_s - d : street_s + d;
    if (!street.closed() && (s < 0.0 || s > street.length())) break;
    points.push_back(street.beside(s, left));
  }
  return points;
}

long cyclistsIn(const std::vector<Actor>& actors) {
  return std::count_if(actors.begin(), actors.end(),
                       [](const Actor& actor) { return actor.kind == ActorKind::kCyclist; });
}

double laneOf(ActorKind kind, bool oncoming) {
  const double right = kind == ActorKind::kCyclist ? kStreet.cycling : kStreet.lane_middle;
  return oncoming ? right : -right;
}

/// A quarter turn from one lane into another: quadratic Bezier curve.
void appendTurn(std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& from,
                const Eigen::Vector3d& corner, const Eigen::Vector3d& to) {
  for (int i = 1; i < 12; ++i) {
    const double t = i / 12.0;
    points.push_back((1 - t) * (1 - t) * from + 2 * t * (1 - t) * corner + t * t * to);
  }
}

}  // namespace

Vehicles::Vehicles(const TrafficParams& params, const Route& route, const RoadNetwork& network,
                   std::uint64_t seed)
    : params_(params), route_(route), network_(network), random_(seed) {}

ActorKind Vehicles::drawKind() {
  const double draw = random_.uniform();
  if (draw < params_.van_ratio) return ActorKind::kVan;
  if (draw < params_.van_ratio + params_.truck_ratio) return ActorKind::kTruck;
  if (draw < params_.van_ratio + params_.truck_ratio + params_.bus_ratio) return ActorKind::kBus;
  return ActorKind::kCar;
}

std::optional<Vehicles::Vehicle> Vehicles::along(ActorKind kind, double street_s, bool oncoming) {
  const double left = laneOf(kind, oncoming);
  const auto points = lanePoints(route_.street, street_s, left, oncoming, kPathReach);
  if (points.size() < 30) return std::nullopt;
  Vehicle vehicle;
  vehicle.intent = oncoming ? Intent::kOncoming : Intent::kAlong;
  vehicle.path = std::make_shared<Path>(points);
  vehicle.street_s = street_s;
  return vehicle;
}

void Vehicles::turnOff(Vehicle& vehicle, bool oncoming) {
  const double direction = oncoming ? -1.0 : 1.0;
  const Road* chosen = nullptr;
  for (const Road* road : network_.crossStreetsNear(vehicle.street_s, 140.0)) {
    const double ahead = direction * route_.ahead(vehicle.street_s, road->main_s);
    if (ahead < 25.0 || ahead > 140.0) continue;
    if (chosen == nullptr || random_.chance(0.4)) chosen = road;
  }
  if (chosen == nullptr) return;
  // To the right at once, to the left when what comes the other way leaves a gap. A cross
  // street's axis runs from the street's right to its left.
  const bool to_left = random_.chance(0.5);
  const double begin_before = to_left ? 7.0 : 11.0;  // the middle of the junction [m]
  const double exit_after = to_left ? 9.0 : 11.0;    // it, on the cross street [m]
  const bool along_axis = to_left != oncoming;
  const double ahead = direction * route_.ahead(vehicle.street_s, chosen->main_s);
  const double left = laneOf(ActorKind::kCar, oncoming);
  auto points = lanePoints(route_.street, vehicle.street_s, left, oncoming, ahead - begin_before);
  std::vector<Eigen::Vector3d> exit;
  for (double d = exit_after; d <= chosen->junction_s - 1.0; d += 1.0) {
    // Away from the junction, keeping right.
    exit.push_back(along_axis ? chosen->axis.beside(chosen->junction_s + d, -kStreet.lane_middle)
                              : chosen->axis.beside(chosen->junction_s - d, kStreet.lane_middle));
  }
  if (points.size() < 5 || exit.size() < 5) return;
  const Eigen::Vector3d begin = points.back();  // a copy: points grows
  const Eigen::Vector3d straight = (begin - points[points.size() - 2]).normalized();
  const Eigen::Vector3d corner = begin + straight * (exit.front() - begin).dot(straight);
  appendTurn(points, begin, corner, exit.front());
  points.insert(points.end(), exit.begin(), exit.end());
  vehicle.path = std::make_shared<Path>(points);
  if (!to_left) return;
  vehicle.yields_to = oncoming ? Yields::kToAlong : Yields::kToOncoming;
  vehicle.yield_s = ahead - begin_before + 3.0;  // waits in the junction
  vehicle.yield_street_s = chosen->main_s;
}

std::optional<Vehicles::Vehicle> Vehicles::crossing(const RobotState& robot, bool anywhere) {
  std::vector<const Road*> near;
  for (const Road* road : network_.crossStreetsNear(robot.s, params_.range_ahead_m)) {
    const double ahead = route_.ahead(robot.s, road->main_s);
    if (ahead > 25.0 && ahead < params_.range_ahead_m) near.push_back(road);
  }
  if (near.empty()) return std::nullopt;
  const Road& road = *near[static_cast<std::size_t>(random_.below(static_cast<int>(near.size())))];
  Vehicle vehicle;
  vehicle.intent = Intent::kCross;
  const bool reversed = random_.chance(0.5);
  vehicle.path = std::make_shared<Path>(
      besidePath(road.axis, reversed ? kStreet.lane_middle : -kStreet.lane_middle, reversed));
  vehicle.yield_s = road.junction_s - 8.6;  // the stop line, before the middle of the street
  vehicle.yield_street_s = road.main_s;
  vehicle.street_s = road.main_s;
  vehicle.place.s = anywhere ? random_.uniform(5.0, road.junction_s - 15.0) : 6.0;
  return vehicle;
}

bool Vehicles::isFree(const Vehicle& vehicle, const RobotState& robot) const {
  const Eigen::Vector2d at = vehicle.path->at(vehicle.place.s).position.head<2>();
  const auto clear = [&](const Eigen::Vector2d& other, double length) {
    return (other - at).norm() > 0.5 * (vehicle.place.length + length) + 5.0;
  };
  return clear(robot.obstacle.position, robot.obstacle.length + 6.0) &&
         std::all_of(actors_.begin(), actors_.end(), [&](const Actor& actor) {
           // A vehicle in the opposite lane does not matter.
           return std::cos(actor.yaw - vehicle.path->at(vehicle.place.s).yaw) < -0.5 ||
                  clear(actor.position.head<2>(), actor.size.x());
         });
}

void Vehicles::spawn(ActorKind kind, const RobotState& robot, bool anywhere,
                     std::int64_t& next_id) {
  const bool cyclist = kind == ActorKind::kCyclist;
  std::optional<Vehicle> vehicle;
  const bool oncoming = random_.chance(params_.oncoming_ratio);
  if (!cyclist && random_.chance(params_.crossing_ratio)) vehicle = crossing(robot, anywhere);
  if (!vehicle) {
    // New ones come into view from far ahead, or overtake from behind on the robot's lane.
    double ahead = random_.uniform(0.85, 1.0) * params_.range_ahead_m;
    if (anywhere) ahead = random_.uniform(cyclist ? 6.0 : 9.0, params_.range_ahead_m);
    vehicle = along(kind, robot.s + ahead, oncoming);
    if (vehicle && !cyclist && random_.chance(params_.turning_ratio)) turnOff(*vehicle, oncoming);
  }
  if (!vehicle) return;
  Actor actor = drawActor(kind, -1, random_);
  vehicle->place.length = actor.size.x();
  vehicle->place.width = actor.size.y();
  const double mean = cyclist ? 4.6 : params_.vehicle_speed_mps;
  vehicle->style.desired_speed_mps = std::max(1.5, mean * (1.0 + 0.15 * random_.normal()));
  if (cyclist) vehicle->style.acceleration = 0.8;
  if (kind == ActorKind::kTruck || kind == ActorKind::kBus) {
    vehicle->style.desired_speed_mps *= 0.85;
    vehicle->style.acceleration = 0.9;
  }
  vehicle->place.speed = vehicle->style.desired_speed_mps * (anywhere ? 0.8 : 0.95);
  if (!isFree(*vehicle, robot)) return;
  actor.id = next_id++;
  vehicles_.push_back(*vehicle);
  actors_.push_back(actor);
  place(vehicles_.size() - 1, 0.0);
}

void Vehicles::populate(const RobotState& robot, std::int64_t& next_id) {
  for (int tries = 0; tries < 40; ++tries) {
    const long cyclists = cyclistsIn(actors_);
    if (cyclists < params_.cyclists) spawn(ActorKind::kCyclist, robot, true, next_id);
    const auto driving = static_cast<long>(actors_.size()) - cyclists;
    for (long missing = params_.vehicles - driving; missing > 0; --missing) {
      spawn(drawKind(), robot, true, next_id);
    }
  }
}

bool Vehicles::gapFor(const Vehicle& vehicle, const RobotState& robot) const {
  const double street_s = vehicle.yield_street_s;
  const auto conflicts = [&](double s, double speed) {  // speed along the street
    if (vehicle.yields_to == Yields::kToOncoming && speed >= 0.0) return false;
    if (vehicle.yields_to == Yields::kToAlong && speed < 0.0) return false;
    const double distance = route_.ahead(s, street_s) * (speed < 0.0 ? -1.0 : 1.0);
    return distance > -6.0 && distance < 7.0 + std::abs(speed) * 4.5;
  };
  if (conflicts(robot.s, robot.speed)) return false;
  for (const Vehicle& other : vehicles_) {
    if (other.intent == Intent::kCross) continue;
    // Two who face each other and both turn left pass each other.
    if (other.yields_to != Yields::kToAll && other.place.speed < 0.5) continue;
    const double sign = other.intent == Intent::kOncoming ? -1.0 : 1.0;
    if (conflicts(other.street_s, sign * std::max(0.1, other.place.speed))) return false;
  }
  return true;
}

void Vehicles::place(std::size_t i, double dt) {
  Vehicle& vehicle = vehicles_[i];
  Actor& actor = actors_[i];
  placeOn(vehicle.path->at(vehicle.place.s), vehicle.place.speed, dt, actor);
  if (vehicle.intent != Intent::kCross) {
    vehicle.street_s =
        route_.street
            .project(actor.position.head<2>(), vehicle.street_s - 4.0, vehicle.street_s + 4.0)
            .s;
  }
}

void Vehicles::retire(const RobotState& robot) {
  for (std::size_t i = vehicles_.size(); i-- > 0;) {
    const Vehicle& vehicle = vehicles_[i];
    const double ahead = route_.ahead(robot.s, vehicle.street_s);
    const bool ended = vehicle.place.s > vehicle.path->length() - 2.0;
    const bool far = ahead > params_.range_ahead_m + 15.0 || ahead < -params_.range_behind_m;
    if (ended || far || vehicle.standing_s > 60.0) {
      vehicles_.erase(vehicles_.begin() + static_cast<long>(i));
      actors_.erase(actors_.begin() + static_cast<long>(i));
    }
  }
}

void Vehicles::advance(double dt, const RobotState& robot, const std::vector<Obstacle>& others,
                       std::int64_t& next_id) {
  std::vector<Obstacle> all = others;
  for (const Actor& actor : actors_) all.push_back(obstacleFrom(actor));
  std::vector<double> accelerations;
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    const Vehicle& vehicle = vehicles_[i];
    double stop = std::numeric_limits<double>::infinity();
    if (vehicle.place.s < vehicle.yield_s && !gapFor(vehicle, robot)) {
      stop = vehicle.yield_s;
    }
    accelerations.push_back(
        drive(vehicle.place, *vehicle.path, vehicle.style, all, actors_[i].id, stop));
  }
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    OnPath& at = vehicles_[i].place;
    at.speed = std::max(0.0, at.speed + accelerations[i] * dt);
    at.s += at.speed * dt;
    vehicles_[i].standing_s = at.speed < 0.1 ? vehicles_[i].standing_s + dt : 0.0;
    place(i, dt);
  }
  retire(robot);
  const long cyclists = cyclistsIn(actors_);
  if (cyclists < params_.cyclists) spawn(ActorKind::kCyclist, robot, false, next_id);
  if (static_cast<long>(actors_.size()) - cyclists < params_.vehicles) {
    spawn(drawKind(), robot, false, next_id);
  }
}

namespace {

/// How near an escort drives to the camera, and how it follows the wanted ratio.
struct EscortStyle {
  double ahead_closest_m = 6.5;    ///< camera to the rear of a vehicle ahead
  double passing_closest_m = 3.0;  ///< camera to the rear of a passing vehicle
  double cyclist_closest_m = 4.5;  ///< camera to the nearer cyclist
  double farthest_back_m = 28.0;   ///< largest distance behind
  double surge = 0.12;             ///< of the distance, to and fro
  double memory = 30.0;            ///< images in which a debt is paid back
  double eagerness = 0.15;         ///< exponent of the correction of each image

  [[nodiscard]] constexpr double farthest() const { return farthest_back_m / passing_closest_m; }
};
constexpr EscortStyle kEscort{};

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
    recruit(kKinds[random_.below(4)], (ahead ? -1.0 : 1.0) * kStreet.lane_middle,
            ahead ? kEscort.ahead_closest_m : kEscort.passing_closest_m, next_id);
  }
  for (const double closest : {kEscort.cyclist_closest_m, kEscort.cyclist_closest_m + 2.6}) {
    if (covers(enough)) return;
    recruit(ActorKind::kCyclist, -kStreet.cycling, closest, next_id);
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
      1.0 + kEscort.surge * std::sin(2.0 * M_PI * time_s_ / member.rhythm_s + member.phase);
  return std::min(member.closest_m * distance_ * surge, kEscort.farthest_back_m);
}

void Escort::place(std::size_t i, double dt) {
  const LaneKeeper& lane = members_[i].lane;
  placeOn(lane.place(), lane.speed, dt, actors_[i]);
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
  double near = 1.0, far = kEscort.farthest();
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
  const double target = params_.image_share;
  const double now = covered(T_world_robot, others);
  images_ += 1.0;
  covered_sum_ += now;
  const double wanted =
      std::clamp(target + (target * images_ - covered_sum_) / kEscort.memory, 0.3 * target, 0.9);
  distance_ *= std::pow(std::max(now, 0.01) / wanted, kEscort.eagerness);
  distance_ = std::clamp(distance_, 1.0, kEscort.farthest());
}

}  // namespace headway::sim
