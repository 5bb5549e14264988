// SPDX-License-Identifier: BSD-3-Clause
// The robot's motion: along a lane, or from stop to stop on a site.
#include "robot.h"

#include <headway/core/error.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace headway::sim {

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

void RobotDriver::follow(const Obstacle& robot) {
  constexpr double kReach = 5.0;  // farther than it moves in a step [m]
  const double from = followed_ ? at_.s - kReach : route_.start_s;
  const double to = followed_ ? at_.s + kReach : route_.end_s;
  at_.s = route_.street.project(robot.position, from, to).s;
  at_.speed = robot.velocity.norm();
  followed_ = robot;
}

RobotState RobotDriver::state() const {
  RobotState state;
  state.s = at_.s;
  state.speed = at_.speed;
  if (followed_) {
    state.obstacle = *followed_;
    return state;
  }
  const PathPoint place = at_.place();
  state.obstacle.id = kRobotId;
  state.obstacle.position = place.position.head<2>();
  state.obstacle.yaw = place.yaw;
  state.obstacle.velocity = at_.speed * Eigen::Vector2d(std::cos(place.yaw), std::sin(place.yaw));
  state.obstacle.length = at_.length;
  state.obstacle.width = at_.width;
  return state;
}

namespace {

/// How a wheeled robot of half a metre is built and driven.
struct Handling {
  double arrived_m = 0.12;         ///< this near to a corner it is reached
  double turn_from_rad = 0.35;     ///< turns on the spot for more than this
  double turn_to_rad = 0.04;       ///< until less than this is left
  double turn_acceleration = 5.0;  ///< [rad/s^2]
  double comfortable_brake = 1.0;  ///< before corners [m/s^2]
  double nod = 0.004;              ///< pitch for each m/s^2 [rad]
  double half_wheelbase_m = 0.17, half_track_m = 0.15;
  double replan_after_s = 4.0;   ///< blocked so long it plans another way
  double half_corridor_m = 0.4;  ///< of the ground that must be free
};
constexpr Handling kHandling{};

double towards(double value, double target, double most_change) {
  return value + std::clamp(target - value, -most_change, most_change);
}

}  // namespace

WheeledRobot::WheeledRobot(const SimParams& params, const Site& site, const NavigationGrid& grid,
                           std::uint64_t seed)
    : route_(params.route),
      params_(params.robot),
      ride_rad_(params.camera.ride_deg * M_PI / 180.0),
      site_(site),
      grid_(grid),
      random_(seed),
      position_(site.robot_stops.front()) {
  planTour();
  chooseStop();
  if (!way_.empty()) {
    const Eigen::Vector2d to = way_.front() - position_;
    // It looks elsewhere at first, so that it begins with a turn.
    double aside = random_.uniform(0.7, 1.5);
    if (!random_.chance(0.5)) aside = -aside;
    yaw_ = wrapAngle(std::atan2(to.y(), to.x()) + aside);
  }
}

void WheeledRobot::planTour() {
  if (params_.tour_stops == 0) return;
  constexpr int kTries = 200;  // for stops that are not on the tour so far
  const Eigen::Vector2d start = position_;
  std::vector<Eigen::Vector2d> tour = {start};
  for (int i = 0; i < kTries && static_cast<int>(tour.size()) <= params_.tour_stops; ++i) {
    chooseStop();
    if (way_.empty()) break;
    const bool is_new = std::none_of(tour.begin(), tour.end(), [&](const Eigen::Vector2d& stop) {
      return (stop - way_.back()).norm() < 1.0;
    });
    if (!is_new) continue;
    position_ = way_.back();
    tour.push_back(position_);
  }
  std::rotate(tour.begin(), tour.begin() + 1, tour.end());  // the start last
  position_ = start;
  tour_ = tour;
}

void WheeledRobot::chooseStop() {
  if (!tour_.empty()) {
    way_ = grid_.path(position_, tour_[toured_++ % tour_.size()], kRadius);
    return;
  }
  constexpr int kNearTries = 60;  // then any stop will do
  for (int tries = 0; tries < 2 * kNearTries; ++tries) {
    const auto& stops = site_.robot_stops;
    const Eigen::Vector2d stop =
        stops[static_cast<std::size_t>(random_.below(static_cast<int>(stops.size())))];
    const double distance = (stop - position_).norm();
    if (distance < 2.5 || (distance > 8.0 && tries < kNearTries)) continue;
    way_ = grid_.path(position_, stop, kRadius);
    if (!way_.empty()) return;
  }
}

DriveCommand WheeledRobot::drive(double distance, double turn) const {
  DriveCommand command;
  const double top_rate = params_.turn_rate_dps * M_PI / 180.0;
  if (turning_) {
    const double braked_in_time =
        std::sqrt(2.0 * 0.8 * kHandling.turn_acceleration * std::abs(turn));
    command.turn_rate = std::copysign(std::min(top_rate, braked_in_time), turn);
    return command;
  }
  // How fast it may be to stop at the corner, or to take it on the way if it is slight.
  double at_corner = 0.0;
  if (way_.size() > 1) {
    const Eigen::Vector2d here = way_[0] - position_, next = way_[1] - way_[0];
    const double bend =
        std::abs(std::atan2(here.x() * next.y() - here.y() * next.x(), here.dot(next)));
    if (bend < kHandling.turn_from_rad) at_corner = route_.speed_mps * (1.0 - bend);
  }
  const double stoppable =
      std::sqrt(at_corner * at_corner + 2.0 * kHandling.comfortable_brake * distance);
  command.speed = std::min(route_.speed_mps, stoppable);
  command.turn_rate = std::clamp(2.5 * turn, -0.5 * top_rate, 0.5 * top_rate);
  return command;
}

DriveCommand WheeledRobot::command(double dt) {
  if (pause_s_ > 0.0) {
    pause_s_ -= dt;
    return {};
  }
  while (!way_.empty() && (way_.front() - position_).norm() < kHandling.arrived_m) {
    way_.erase(way_.begin());
    if (!way_.empty()) continue;
    chooseStop();
    pause_s_ = random_.uniform(0.2, 1.2);
    return {};
  }
  if (way_.empty()) return {};
  const Eigen::Vector2d to = way_.front() - position_;
  const double turn = wrapAngle(std::atan2(to.y(), to.x()) - yaw_);
  if (std::abs(turn) > kHandling.turn_from_rad) turning_ = true;
  if (std::abs(turn) < kHandling.turn_to_rad) turning_ = false;
  return drive(to.norm(), turn);
}

bool WheeledRobot::mustStop(const std::vector<Obstacle>& others) const {
  const Eigen::Vector2d forward(std::cos(yaw_), std::sin(yaw_)), left(-forward.y(), forward.x());
  const double reach = 0.55 + 0.3 * speed_ + speed_ * speed_ / (2.0 * params_.brake_mps2);
  return std::any_of(others.begin(), others.end(), [&](const Obstacle& other) {
    const double half_size = other.on_foot ? 0.15 : 0.5 * std::max(other.length, other.width);
    for (const double soon : {0.0, 0.4, 0.8}) {
      const Eigen::Vector2d to = other.position + soon * other.velocity - position_;
      const double along = to.dot(forward) - soon * speed_ - half_size;
      const double across = std::abs(to.dot(left)) - half_size;
      if (along > -0.2 && along < reach && across < kHandling.half_corridor_m) return true;
    }
    return false;
  });
}

void WheeledRobot::advance(double dt, const std::vector<Obstacle>& others) {
  if (steered_) return move(dt, *steered_, params_.brake_mps2);
  if (params_.standing) return;
  DriveCommand wanted = command(dt);
  if (sudden_stop_s_ <= 0.0 && speed_ > 0.3 && random_.chance(params_.sudden_stop_rate_hz * dt)) {
    sudden_stop_s_ = 0.8;
  }
  sudden_stop_s_ -= dt;
  const bool blocked = wanted.speed > 0.0 && mustStop(others);
  blocked_s_ = blocked ? blocked_s_ + dt : 0.0;
  if (blocked || sudden_stop_s_ > 0.0) wanted.speed = 0.0;
  if (blocked_s_ > kHandling.replan_after_s) {
    chooseStop();
    blocked_s_ = 0.0;
  }
  if (turning_ && speed_ > 0.02) wanted.turn_rate = 0.0;  // only at a standstill
  const bool hard = blocked || sudden_stop_s_ > 0.0;
  move(dt, wanted, hard ? params_.brake_mps2 : 2.0 * kHandling.comfortable_brake);
}

void WheeledRobot::move(double dt, const DriveCommand& wanted, double brake) {
  const double before = speed_;
  before_ = {position_.x(), position_.y(), yaw_};
  const bool faster = std::abs(wanted.speed) > std::abs(speed_) && wanted.speed * speed_ >= 0.0;
  speed_ = towards(speed_, wanted.speed, dt * (faster ? params_.acceleration_mps2 : brake));
  turn_rate_ = towards(turn_rate_, wanted.turn_rate, dt * kHandling.turn_acceleration);
  const double middle_yaw = yaw_ + 0.5 * dt * turn_rate_;
  position_ += dt * speed_ * Eigen::Vector2d(std::cos(middle_yaw), std::sin(middle_yaw));
  yaw_ = wrapAngle(yaw_ + dt * turn_rate_);
  const double motion = std::min(1.0, std::abs(speed_) / std::max(0.5, route_.speed_mps));
  pitch_.advance(dt, ride_rad_, motion, -kHandling.nod * (speed_ - before) / dt, random_);
  roll_.advance(dt, ride_rad_, motion, 0.0, random_);
  if (!course_) return;
  constexpr double kAhead = 2.0;  // it cuts no more of its course at once [m]
  const double end = std::min(course_->length(), progress_ + kAhead);
  progress_ = std::max(progress_, course_->project(position_, progress_, end).s);
}

void WheeledRobot::takeCourse(const std::vector<Eigen::Vector2d>& course) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector2d& corner : course) points.emplace_back(corner.x(), corner.y(), 0.0);
  course_.emplace(points);
  position_ = course.front();
  const Eigen::Vector2d to = course[1] - course[0];
  yaw_ = std::atan2(to.y(), to.x());
  speed_ = turn_rate_ = 0.0;
  steer({});
}

void WheeledRobot::undoStep() {
  position_ = before_.head<2>();
  yaw_ = before_.z();
  speed_ = turn_rate_ = 0.0;
}

namespace {

/// Corners, the start first, of a way between two of the robot's stops, of 15 to 30 m if there is
/// one, else as near to that as there is.
std::vector<Eigen::Vector2d> planCourse(const Site& site, const NavigationGrid& grid,
                                        Random& random) {
  constexpr double kMin = 15.0, kMax = 30.0;  // length of a course [m]
  constexpr int kTries = 60;                  // pairs of stops; then the one nearest to that
  std::vector<Eigen::Vector2d> best;
  double best_excess = std::numeric_limits<double>::infinity();
  const auto stop = [&] {
    const int count = static_cast<int>(site.robot_stops.size());
    return site.robot_stops[static_cast<std::size_t>(random.below(count))];
  };
  for (int i = 0; i < kTries && best_excess > 0.0; ++i) {
    const Eigen::Vector2d start = stop(), goal = stop();
    if ((goal - start).norm() < 2.5 || (goal - start).norm() > kMax) continue;
    auto course = grid.path(start, goal, WheeledRobot::kRadius);
    if (course.empty()) continue;
    course.insert(course.begin(), start);
    double length = 0.0;
    for (std::size_t k = 1; k < course.size(); ++k) length += (course[k] - course[k - 1]).norm();
    const double excess = std::max({0.0, kMin - length, length - kMax});
    if (excess >= best_excess) continue;
    best_excess = excess;
    best = std::move(course);
  }
  return best;
}

}  // namespace

WheeledRobot steeredRobot(const SimParams& params, const Site& site, const NavigationGrid& grid,
                          std::uint64_t seed) {
  constexpr std::uint64_t kRideSeed = 503, kCourseSeed = 508;  // beside those of a site
  WheeledRobot robot(params, site, grid, seedOf({seed, kRideSeed}));
  Random random(seedOf({seed, kCourseSeed}));
  const auto course = planCourse(site, grid, random);
  if (course.empty()) throw InputError("[world] seed: no two places of this world have a way");
  robot.takeCourse(course);
  return robot;
}

Pose WheeledRobot::T_world_robot() const {
  const Eigen::Vector2d forward(std::cos(yaw_), std::sin(yaw_));
  const Eigen::Vector2d left(-forward.y(), forward.x());
  const double front = wheelHeight(site_, position_ + kHandling.half_wheelbase_m * forward);
  const double rear = wheelHeight(site_, position_ - kHandling.half_wheelbase_m * forward);
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(position_.x(), position_.y(), 0.5 * (front + rear));
  const double climb = std::atan2(front - rear, 2.0 * kHandling.half_wheelbase_m);
  const double bank = std::atan2(groundHeight(site_, position_ + kHandling.half_track_m * left) -
                                     groundHeight(site_, position_ - kHandling.half_track_m * left),
                                 2.0 * kHandling.half_track_m);
  pose.linear() = (Eigen::AngleAxisd(yaw_, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(pitch_.angle - climb, Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(roll_.angle + bank, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  return pose;
}

Obstacle WheeledRobot::obstacle() const {
  return {kRobotId, position_, speed_ * Eigen::Vector2d(std::cos(yaw_), std::sin(yaw_)), yaw_, 0.6,
          0.5,      false};
}

Eigen::Vector2d WheeledRobot::ahead(double distance) const {
  if (course_) {
    return course_->at(std::min(progress_ + distance, course_->length())).position.head<2>();
  }
  Eigen::Vector2d at = position_;
  for (const Eigen::Vector2d& corner : way_) {
    const double length = (corner - at).norm();
    if (length >= distance) return at + (corner - at) * (distance / length);
    distance -= length;
    at = corner;
  }
  return at;
}

}  // namespace headway::sim
