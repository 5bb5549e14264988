#include "crowd.h"

#include <algorithm>
#include <cmath>

namespace headway::app {
namespace {

using Eigen::Vector2d;

constexpr double kDegree = M_PI / 180.0;

Vector2d direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// Side step of somebody who gives way: the stronger the nearer the robot, none beyond 1.5 m.
Vector2d givingWay(const Person& person, const Vector2d& robot) {
  const Vector2d away = person.position - robot;
  const double distance = std::max(0.1, away.norm());
  return std::max(0.0, 1.5 - distance) * 0.8 * away / distance;
}

}  // namespace

Vector2d Person::velocity() const {
  return speed * std::max(0.0, 1.0 + speed_off) * direction(heading + heading_off);
}

Crowd::Crowd(const PeopleParams& people, const RobotParams& robot, std::uint64_t seed)
    : params_(people), random_(seed) {
  Scenario scenario = people.scenario;
  if (scenario == Scenario::kMixed) {
    scenario = scenarios()[static_cast<std::size_t>(uniform(0.0, 4.0))].second;
  }
  placePillars(robot.goal_m);
  placePeople(scenario, robot);
}

void Crowd::placePillars(double goal_m) {
  for (int i = 0; i < params_.pillars; ++i) {
    const double side = uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0;
    pillars_.push_back({{uniform(0.1, 0.9) * goal_m, side * uniform(2.5, 5.0)}, 0.2});
  }
}

void Crowd::placePeople(Scenario scenario, const RobotParams& robot) {
  for (int i = 0; i < params_.count; ++i) {
    switch (scenario) {
      case Scenario::kFollowing:
        placeAlong(i, false, robot);
        break;
      case Scenario::kOncoming:
        placeAlong(i, true, robot);
        break;
      case Scenario::kGroups:
        placeCrossing(i, 2 + static_cast<int>(uniform(0.0, 2.0)), robot);
        break;
      case Scenario::kCrossing:
      case Scenario::kMixed:
        placeCrossing(i, 1, robot);
        break;
    }
  }
}

/// People who reach the robot's straight way about when a robot at full speed does.
void Crowd::placeCrossing(int index, int abreast, const RobotParams& robot) {
  const double share = (index + 1.0) / (params_.count + 1.0);
  const Vector2d meeting((share + uniform(-0.08, 0.08)) * robot.goal_m, 0.0);
  const double robot_there_s = meeting.x() / robot.top_speed + 0.5;
  const double side = uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0;
  Person person;
  person.heading = side * M_PI / 2.0 + normal(params_.angle_sigma_deg * kDegree);
  person.speed = uniform(params_.slow_speed, params_.fast_speed);
  const double time = std::max(1.0, robot_there_s + normal(params_.timing_sigma_s));
  person.position = meeting - time * person.speed * direction(person.heading);
  for (int i = 0; i < abreast; ++i) {
    add(person);
    person.position += 2.6 * params_.radius_m * direction(person.heading + M_PI / 2.0);
  }
}

/// People on the robot's way: ahead of it and slower, or towards it.
void Crowd::placeAlong(int index, bool oncoming, const RobotParams& robot) {
  const double pace = oncoming ? 1.0 : 0.6;
  Person person;
  person.heading = oncoming ? M_PI : 0.0;
  person.speed = pace * uniform(params_.slow_speed, std::min(params_.fast_speed, 1.2));
  const double spacing = robot.goal_m / (params_.count + 1.0);
  const double x = oncoming ? robot.goal_m + index * 2.0 * spacing : 1.5 + index * spacing;
  person.position = {x, normal(0.3)};
  add(person);
}

void Crowd::walk(double dt_s, const Vector2d& robot) {
  // First-order Gauss-Markov: the spread stays, the memory fades with wander_time.
  const double keep = std::exp(-dt_s / params_.wander_time_s);
  const double renew = std::sqrt(1.0 - keep * keep);
  for (auto& person : people_) {
    const double turn = normal(params_.wander_sigma_deg * kDegree);
    const double hurry = normal(params_.speed_sigma);
    person.heading_off = keep * person.heading_off + renew * turn;
    person.speed_off = keep * person.speed_off + renew * hurry;
    Vector2d velocity = person.velocity();
    if (person.yields) velocity += givingWay(person, robot);
    person.position += dt_s * velocity;
  }
}

double Crowd::normal(double sigma) {
  return sigma * std::normal_distribution<double>(0.0, 1.0)(random_);
}

double Crowd::uniform(double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(random_);
}

void Crowd::add(Person person) {
  person.radius = params_.radius_m;
  person.yields = uniform(0.0, 1.0) < params_.yielding_share;
  people_.push_back(person);
}

}  // namespace headway::app
