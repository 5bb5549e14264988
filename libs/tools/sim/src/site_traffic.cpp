// SPDX-License-Identifier: BSD-3-Clause
// People and vehicles that move on a site.
#include "site_traffic.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace headway::sim {
namespace {

/// How people walk indoors.
struct WalkerStyle {
  double radius_m = 0.28;            ///< half a person's width
  double each_other_m = 0.65;        ///< distance of two people who pass
  double nearest_to_robot_m = 0.58;  ///< of a person and the robot, middle to middle
  double foresight_s = 2.5;          ///< people foresee that much
  double relaxation_s = 0.35;        ///< to reach the desired velocity
  double acceleration = 2.5;         ///< at most [m/s^2]
};
constexpr WalkerStyle kWalker{};

Eigen::Vector2d limited(const Eigen::Vector2d& v, double most) {
  return v.norm() > most ? Eigen::Vector2d(v * (most / v.norm())) : v;
}

/// Change of velocity that lets somebody pass another at a distance.
///
/// @param to        the other's place from here [m]
/// @param velocity  own velocity relative to the other [m/s]
Eigen::Vector2d sideStep(const Eigen::Vector2d& to, const Eigen::Vector2d& velocity,
                         double distance) {
  const double closing = velocity.squaredNorm();
  if (closing < 0.01) return Eigen::Vector2d::Zero();
  const double time = to.dot(velocity) / closing;
  if (time < 0.0 || time > kWalker.foresight_s) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d miss = velocity * time - to;  // from the other, when nearest
  const double lacking = distance - miss.norm();
  if (lacking <= 0.0) return Eigen::Vector2d::Zero();
  // Straight towards each other: both go to their right.
  const Eigen::Vector2d right(velocity.y(), -velocity.x());
  const Eigen::Vector2d away = miss.norm() > 0.05 ? miss.normalized() : right.normalized();
  return away * lacking / std::max(0.5, time);
}

}  // namespace

Walkers::Walkers(const TrafficParams& params, const Site& site, const NavigationGrid& grid,
                 std::uint64_t seed)
    : params_(params), site_(site), grid_(grid), random_(seed), bodies_(seedOf({seed, 1})) {}

void Walkers::addActor(const Person& person, ActorKind kind, double yaw, std::int64_t& next_id) {
  Actor actor = drawActor(kind, next_id++, random_);
  if (params_.varied_bodies) varyBody(bodies_, actor);
  actor.gait = random_.uniform(0.0, 2.0 * M_PI);
  actor.yaw = yaw;
  actors_.push_back(actor);
  people_.push_back(person);
  place(people_.size() - 1, 0.0);
}

void Walkers::addIdle(const Spot& spot, std::int64_t& next_id) {
  Person person;
  person.at = spot.position;
  person.idle = true;
  addActor(person, spot.seat ? ActorKind::kSeatedPerson : ActorKind::kPedestrian,
           spot.yaw + (spot.seat ? 0.0 : random_.uniform(-0.4, 0.4)), next_id);
}

void Walkers::addWalker(const WheeledRobot& robot, std::int64_t& next_id) {
  Person person;
  for (int tries = 0; tries < 200; ++tries) {
    const double y = random_.uniform(), x = random_.uniform();
    person.at = site_.area.min() + site_.area.sizes().cwiseProduct(Eigen::Vector2d(x, y));
    const bool free = grid_.clearance(person.at) > 0.5 &&
                      (person.at - robot.position()).norm() > 1.8 &&
                      !grid_.path(person.at, site_.robot_stops.front(), kWalker.radius_m).empty();
    if (!free) continue;
    person.desired_speed_mps =
        std::clamp(params_.walking_speed_mps + 0.22 * random_.normal(), 0.5, 2.0);
    person.pause_s = random_.chance(0.25) ? random_.uniform(0.5, 5.0) : 0.0;
    chooseWay(person, robot);
    addActor(person, ActorKind::kPedestrian, random_.uniform(-M_PI, M_PI), next_id);
    return;
  }
}

void Walkers::populate(const WheeledRobot& robot, std::int64_t& next_id) {
  std::vector<Spot> spots = site_.spots;
  for (int i = 0; i < params_.idle_people && !spots.empty(); ++i) {
    const auto which = static_cast<std::size_t>(random_.below(static_cast<int>(spots.size())));
    addIdle(spots[which], next_id);
    spots.erase(spots.begin() + static_cast<long>(which));
  }
  for (int i = 0; i < params_.pedestrians; ++i) addWalker(robot, next_id);
}

void Walkers::meet(const WheeledRobot& robot, std::uint64_t seed, std::int64_t& next_id) {
  Random random(seed);
  constexpr int kKinds = static_cast<int>(Meeting::kHidden) + 1;
  constexpr double kFirst = 5.0, kSpacing = 3.5, kLast = 2.0;  // of places of meetings [m]
  const Path& course = *robot.course();
  int kind = random.below(kKinds);
  for (double s = kFirst; s < course.length() - kLast; s += kSpacing + random.uniform()) {
    for (int tries = 0; tries < kKinds; ++tries) {
      const auto person = meetingAt(static_cast<Meeting>(kind++ % kKinds), course, s, random);
      if (!person) continue;
      addActor(*person, ActorKind::kPedestrian, random.uniform(-M_PI, M_PI), next_id);
      break;
    }
  }
  for (Person& person : people_) person.ignores_robot = random.chance(0.5);
}

std::optional<Eigen::Vector2d> Walkers::besideCourse(const Path& course, double s, bool hidden,
                                                     Random& random) const {
  constexpr int kTries = 60;
  constexpr double kNearest = 1.0, kFarthest = 4.0;  // from the course [m]
  constexpr double kSeenFrom = 3.0;  // the robot is so far away when it must not see them [m]
  const Eigen::Vector2d at = course.at(s).position.head<2>();
  const Eigen::Vector2d robot = course.at(std::max(0.0, s - kSeenFrom)).position.head<2>();
  for (int i = 0; i < kTries; ++i) {
    const double angle = random.uniform(-M_PI, M_PI),
                 distance = random.uniform(kNearest, kFarthest);
    const Eigen::Vector2d place = at + distance * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const double across = std::abs(std::sin(angle - course.at(s).yaw));
    if (grid_.clearance(place) < kWalker.radius_m + 0.1) continue;
    const auto nearest = course.project(place, 0.0, course.length());
    if ((course.at(nearest.s).position.head<2>() - place).norm() < kNearest) continue;
    if (hidden ? !grid_.isClear(robot, place, 0.05)
               : across > 0.8 && grid_.isClear(at, place, kWalker.radius_m)) {
      return place;
    }
  }
  return std::nullopt;
}

std::optional<Walkers::Person> Walkers::meetingAt(Meeting kind, const Path& course, double s,
                                                  Random& random) const {
  constexpr double kRobotSpeed = 0.9;  // on its way, roughly [m/s]
  const auto at = [&](double place, double left = 0.0) {
    return Eigen::Vector2d(course.beside(std::clamp(place, 0.0, course.length()), left).head<2>());
  };
  const double side = random.chance(0.5) ? 0.4 : -0.4;  // [m]
  Person person;
  person.desired_speed_mps =
      std::clamp(params_.walking_speed_mps + 0.22 * random.normal(), 0.6, 1.6);
  Eigen::Vector2d to = at(course.length());
  switch (kind) {
    case Meeting::kOncoming:
      person.at = at(s + 4.0);
      to = at(0.0);
      person.sets_off_m = s - 4.0 * kRobotSpeed / person.desired_speed_mps;
      break;
    case Meeting::kOvertaken:
      person.at = at(s + 1.0);
      person.desired_speed_mps = 0.45;
      person.sets_off_m = s - 2.0;
      break;
    case Meeting::kOvertaking:
      if (s < 7.0) return std::nullopt;  // the robot starts there
      person.at = at(s - 4.5, side);
      person.desired_speed_mps = 1.5;
      person.sets_off_m = s - 2.0;
      break;
    case Meeting::kStanding:
      person.at = at(s, side);
      person.idle = true;
      break;
    case Meeting::kCrossing:
    case Meeting::kHidden: {
      const auto place = besideCourse(course, s, kind == Meeting::kHidden, random);
      if (!place) return std::nullopt;
      person.at = *place;
      to = at(s);
      break;
    }
  }
  if (grid_.clearance(person.at) < kWalker.radius_m) return std::nullopt;
  if (person.idle) {  // beside whom the robot can pass
    return grid_.clearance(at(s)) > 0.9 ? std::optional(person) : std::nullopt;
  }
  person.way = grid_.path(person.at, to, kWalker.radius_m);
  if (person.way.empty()) return std::nullopt;
  if (kind == Meeting::kCrossing || kind == Meeting::kHidden) {
    double length = (person.way.front() - person.at).norm();
    for (std::size_t i = 1; i < person.way.size(); ++i) {
      length += (person.way[i] - person.way[i - 1]).norm();
    }
    if (length > 6.0) return std::nullopt;
    person.sets_off_m = s - length * kRobotSpeed / person.desired_speed_mps;
  }
  prolongWay(person, random);
  return person;
}

void Walkers::chooseWay(Person& person, const WheeledRobot& robot) {
  person.way.clear();
  if (random_.chance(params_.encounter_ratio)) {  // to where the robot is going, and on past it
    const Eigen::Vector2d meeting = robot.ahead(random_.uniform(1.5, 6.0));
    if (grid_.clearance(meeting) > kWalker.radius_m && (meeting - person.at).norm() > 1.0) {
      person.way = grid_.path(person.at, meeting, kWalker.radius_m);
    }
  }
  prolongWay(person, random_);
}

void Walkers::prolongWay(Person& person, Random& random) const {
  const Eigen::Vector2d from = person.way.empty() ? person.at : person.way.back();
  for (int tries = 0; tries < 10; ++tries) {
    const auto& places = site_.destinations;
    const Eigen::Vector2d place =
        places[static_cast<std::size_t>(random.below(static_cast<int>(places.size())))];
    if ((place - from).norm() < 2.0) continue;
    const auto rest = grid_.path(from, place, kWalker.radius_m);
    if (rest.empty()) continue;
    person.way.insert(person.way.end(), rest.begin(), rest.end());
    return;
  }
}

Eigen::Vector2d Walkers::desiredVelocity(Person& person, double dt, const WheeledRobot& robot) {
  if (person.idle) return Eigen::Vector2d::Zero();
  constexpr double kInTheWay = 1.5;  // who waits does not stop a robot so near [m]
  if (robot.progress() < person.sets_off_m && (robot.position() - person.at).norm() > kInTheWay) {
    person.stuck_s = 0.0;
    return Eigen::Vector2d::Zero();
  }
  if (person.pause_s > 0.0) {
    person.pause_s -= dt;
    return Eigen::Vector2d::Zero();
  }
  if (random_.chance(params_.stop_rate_hz * dt)) {
    person.pause_s = random_.uniform(1.0, 4.0);
    if (random_.chance(0.4)) chooseWay(person, robot);  // turns round
  }
  const auto reached = [&](const Eigen::Vector2d& corner) {
    const double distance = (corner - person.at).norm();
    const bool taken = (corner - robot.position()).norm() < 0.9;  // the robot stands there
    return distance < (taken ? 1.6 : 0.45);
  };
  while (!person.way.empty() && reached(person.way.front())) person.way.erase(person.way.begin());
  if (person.way.empty() || person.stuck_s > 3.0) {
    person.stuck_s = 0.0;
    person.pause_s = random_.uniform(0.0, 3.0);
    chooseWay(person, robot);
    return Eigen::Vector2d::Zero();
  }
  return person.desired_speed_mps * (person.way.front() - person.at).normalized();
}

Eigen::Vector2d Walkers::avoiding(std::size_t i, Eigen::Vector2d velocity, const Obstacle& robot,
                                  const std::vector<Obstacle>& vehicles) const {
  const Person& person = people_[i];
  const Eigen::Vector2d wanted = velocity;
  if (!person.ignores_robot) {
    velocity += sideStep(robot.position - person.at, wanted - robot.velocity, kPassing + 0.02);
  }
  for (const Obstacle& vehicle : vehicles) {
    velocity += sideStep(vehicle.position - person.at, wanted - vehicle.velocity,
                         0.5 * vehicle.width + 0.45);
  }
  for (std::size_t k = 0; k < people_.size(); ++k) {
    if (k == i) continue;
    const Eigen::Vector2d to = people_[k].at - person.at;
    const double part = people_[k].velocity.norm() > 0.1 ? 0.6 : 1.0;  // both step aside
    velocity += part * sideStep(to, wanted - people_[k].velocity, kWalker.each_other_m);
    if (to.norm() < 0.5) velocity -= 1.5 * to.normalized() * (0.5 - to.norm()) / 0.1;
  }
  return limited(velocity, 1.25 * std::max(person.desired_speed_mps, wanted.norm()));
}

void Walkers::move(Person& person, double dt, const Obstacle& robot) const {
  const Eigen::Vector2d before = person.at;
  const auto blocked = [&](const Eigen::Vector2d& at) {
    const double room = grid_.clearance(at);
    const Eigen::Vector2d from_robot = at - robot.position;
    const bool nearer = from_robot.norm() < (before - robot.position).norm();
    return (room < kWalker.radius_m && room <= grid_.clearance(before)) ||
           (!person.ignores_robot && from_robot.norm() < kWalker.nearest_to_robot_m && nearer);
  };
  const Eigen::Vector2d step = dt * person.velocity;
  // Along a wall where the way itself is closed.
  for (const Eigen::Vector2d& tried :
       {step, Eigen::Vector2d(step.x(), 0.0), Eigen::Vector2d(0.0, step.y())}) {
    if (blocked(before + tried)) continue;
    person.at = before + tried;
    break;
  }
  person.velocity = (person.at - before) / dt;
  const bool walking = person.pause_s <= 0.0 && !person.idle;
  person.stuck_s = walking && person.velocity.norm() < 0.1 ? person.stuck_s + dt : 0.0;
}

void Walkers::place(std::size_t i, double dt) {
  const Person& person = people_[i];
  Actor& actor = actors_[i];
  actor.position = Eigen::Vector3d(person.at.x(), person.at.y(), groundHeight(site_, person.at));
  actor.velocity = person.velocity;
  actor.speed = person.velocity.norm();
  if (actor.speed > 0.15) {
    const double wanted = std::atan2(actor.velocity.y(), actor.velocity.x());
    actor.yaw += std::clamp(wrapAngle(wanted - actor.yaw), -4.0 * dt, 4.0 * dt);
  }
  actor.yaw = wrapAngle(actor.yaw);
  swingLimbs(dt, actor);
}

void Walkers::advance(double dt, const WheeledRobot& robot, const std::vector<Obstacle>& vehicles) {
  const Obstacle seen = robot.obstacle();
  std::vector<Eigen::Vector2d> wanted;
  for (std::size_t i = 0; i < people_.size(); ++i) {
    const Eigen::Vector2d velocity = desiredVelocity(people_[i], dt, robot);
    wanted.push_back(people_[i].idle ? velocity : avoiding(i, velocity, seen, vehicles));
  }
  for (std::size_t i = 0; i < people_.size(); ++i) {
    Person& person = people_[i];
    if (person.idle) continue;
    person.velocity +=
        dt * limited((wanted[i] - person.velocity) / kWalker.relaxation_s, kWalker.acceleration);
    move(person, dt, seen);
    place(i, dt);
  }
}

namespace {

/// Of people who cover the view.
struct CoverStyle {
  double width_m = 0.165;  ///< that the legs of one hide, which small robots see
  double nearest_m = 1.0;  ///< to the camera
  double sway_m = 0.1;     ///< to either side
};
constexpr CoverStyle kCover{};

}  // namespace

CoveringPeople::CoveringPeople(const TrafficParams& params, const StereoCamera& camera,
                               std::uint64_t seed, std::int64_t& next_id)
    : camera_(camera) {
  if (params.cover == 0.0) return;
  const double covered_px = -std::log(1.0 - params.cover) * camera.width;  // some hide others
  const double count = std::ceil(covered_px * kCover.nearest_m / (camera.fx * kCover.width_m));
  ahead_m_ = count * camera.fx * kCover.width_m / covered_px;
  Random random(seed);
  for (int i = 0; i < static_cast<int>(count); ++i) {
    sways_.push_back(random.uniform(1.0, 2.5));
    actors_.push_back(drawActor(ActorKind::kPedestrian, next_id++, random));
  }
}

void CoveringPeople::advance(double dt, const Pose& T_world_robot) {
  seconds_ += dt;
  const Pose T_world_cam = T_world_robot * camera_.T_robot_cam;
  const double half_view_m = 0.5 * camera_.width / camera_.fx * ahead_m_;
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    Actor& actor = actors_[i];
    const double spread = (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(sways_.size());
    const double right =
        half_view_m * (spread - 1.0) + kCover.sway_m * std::sin(sways_[i] * seconds_);
    const Eigen::Vector3d before = actor.position;
    actor.position = T_world_cam * Eigen::Vector3d(right, 0.0, ahead_m_);
    actor.position.z() = T_world_robot.translation().z();
    actor.yaw = yawOf(T_world_robot);
    if (dt > 0.0) actor.velocity = (actor.position - before).head<2>() / dt;
    actor.speed = actor.velocity.norm();
    swingLimbs(dt, actor);
  }
}

namespace {

/// The first place from `s` on from which a vehicle can brake for the robot; `s` if there is none.
double startClearOf(const Obstacle& robot, const Path& path, double s, double vehicle_length_m) {
  // With the 2.5 m in which a forklift stops.
  const double needed = 0.5 * (vehicle_length_m + robot.length) + 2.5;
  for (double ahead = 0.0; ahead < path.length(); ahead += 0.5) {
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
  const Actor actor = drawActor(loop.kind, next_id++, random_);
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
  const double way = (point.position - actor.position).norm();
  placeOn(point, dt > 0.0 ? way / dt : vehicle.at.speed, dt, actor);
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
