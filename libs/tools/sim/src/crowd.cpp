// SPDX-License-Identifier: BSD-3-Clause
// People and pillars of a trial of navigation, seen from above.
#include <headway/core/pose.h>
#include <headway/sim/crowd.h>

#include <algorithm>
#include <cmath>

namespace headway::sim {
namespace {

using Eigen::Vector2d;

Vector2d unitVector(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// Side step of somebody who gives way: the stronger the nearer the robot, none beyond 1.5 m.
Vector2d givingWay(const Person& person, const Vector2d& robot) {
  const Vector2d away = person.position - robot;
  const double distance = std::max(0.1, away.norm());
  return std::max(0.0, 1.5 - distance) * 0.8 * away / distance;
}

}  // namespace

const std::vector<std::pair<std::string, Scenario>>& scenarios() {
  static const std::vector<std::pair<std::string, Scenario>> names = {
      {"crossing", Scenario::kCrossing},
      {"following", Scenario::kFollowing},
      {"oncoming", Scenario::kOncoming},
      {"groups", Scenario::kGroups},
      {"mixed", Scenario::kMixed}};
  return names;
}

void PeopleParams::describe(Params::Section section) {
  section.add("scenario", scenario, scenarios(), "How people walk");
  section.add("count", count, 0, 100, "", "People (or groups) in a trial");
  section.add("radius_m", radius_m, 0.05, 1.0, "m", "Radius of a person");
  section.add("min_speed_mps", min_speed_mps, 0.1, 5.0, "m/s", "Minimum preferred speed");
  section.add("max_speed_mps", max_speed_mps, 0.1, 5.0, "m/s", "Maximum preferred speed");
  section.add("timing_sigma_s", timing_sigma_s, 0.0, 10.0, "s",
              "Standard deviation of the times at which crossing people meet the robot");
  section.add("angle_sigma_deg", angle_sigma_deg, 0.0, 60.0, "deg",
              "Standard deviation of crossing directions about the perpendicular");
  section.add("wander_sigma_deg", wander_sigma_deg, 0.0, 60.0, "deg",
              "Standard deviation of a heading about the preferred one");
  section.add("speed_sigma_ratio", speed_sigma_ratio, 0.0, 0.5, "-",
              "Standard deviation of a speed, relative to the preferred one");
  section.add("wander_time_s", wander_time_s, 0.1, 60.0, "s",
              "Correlation time of heading and speed");
  section.add("yielding_fraction", yielding_fraction, 0.0, 1.0, "-",
              "Fraction of people who give way to the robot; the others ignore it");
  section.add("pillars", pillars, 0, 100, "", "Pillars beside the straight path");
}

Vector2d Person::velocity() const {
  return speed * std::max(0.0, 1.0 + speed_off) * unitVector(heading + heading_off);
}

Crowd::Crowd(const PeopleParams& people, const RobotCourse& course, std::uint64_t seed)
    : params_(validated(people)), random_(seed) {
  Scenario scenario = people.scenario;
  if (scenario == Scenario::kMixed) {
    scenario = scenarios()[static_cast<std::size_t>(uniform(0.0, 4.0))].second;
  }
  placePillars(course.goal_m);
  placePeople(scenario, course);
}

void Crowd::placePillars(double goal_m) {
  for (int i = 0; i < params_.pillars; ++i) {
    const double side = uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0;
    pillars_.push_back({{uniform(0.1, 0.9) * goal_m, side * uniform(2.5, 5.0)}, 0.2});
  }
}

void Crowd::placePeople(Scenario scenario, const RobotCourse& course) {
  for (int i = 0; i < params_.count; ++i) {
    switch (scenario) {
      case Scenario::kFollowing:
        placeAlong(i, false, course);
        break;
      case Scenario::kOncoming:
        placeAlong(i, true, course);
        break;
      case Scenario::kGroups:
        placeCrossing(i, 2 + static_cast<int>(uniform(0.0, 2.0)), course);
        break;
      case Scenario::kCrossing:
      case Scenario::kMixed:
        placeCrossing(i, 1, course);
        break;
    }
  }
}

/// People who reach the robot's straight way about when a robot at full speed does.
void Crowd::placeCrossing(int index, int abreast, const RobotCourse& course) {
  const double ratio = (index + 1.0) / (params_.count + 1.0);
  const Vector2d meeting((ratio + uniform(-0.08, 0.08)) * course.goal_m, 0.0);
  const double robot_there_s = meeting.x() / course.top_speed_mps + 0.5;
  const double side = uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0;
  Person person;
  person.heading = side * M_PI / 2.0 + normal(params_.angle_sigma_deg * kDegree);
  person.speed = uniform(params_.min_speed_mps, params_.max_speed_mps);
  const double time = std::max(1.0, robot_there_s + normal(params_.timing_sigma_s));
  person.position = meeting - time * person.speed * unitVector(person.heading);
  for (int i = 0; i < abreast; ++i) {
    add(person);
    person.position += 2.6 * params_.radius_m * unitVector(person.heading + M_PI / 2.0);
  }
}

/// People on the robot's way: ahead of it and slower, or towards it.
void Crowd::placeAlong(int index, bool oncoming, const RobotCourse& course) {
  const double pace = oncoming ? 1.0 : 0.6;
  Person person;
  person.heading = oncoming ? M_PI : 0.0;
  person.speed = pace * uniform(params_.min_speed_mps, std::min(params_.max_speed_mps, 1.2));
  const double spacing = course.goal_m / (params_.count + 1.0);
  const double x = oncoming ? course.goal_m + index * 2.0 * spacing : 1.5 + index * spacing;
  person.position = {x, normal(0.3)};
  add(person);
}

void Crowd::walk(double dt_s, const Vector2d& robot) {
  // First-order Gauss-Markov: the spread stays, the memory fades with wander_time.
  const double keep = std::exp(-dt_s / params_.wander_time_s);
  const double renew = std::sqrt(1.0 - keep * keep);
  for (auto& person : people_) {
    const double turn = normal(params_.wander_sigma_deg * kDegree);
    const double hurry = normal(params_.speed_sigma_ratio);
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
  person.yields = uniform(0.0, 1.0) < params_.yielding_fraction;
  people_.push_back(person);
}

}  // namespace headway::sim
