// SPDX-License-Identifier: BSD-3-Clause
#include "traffic.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "lens.h"

namespace headway::sim {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

Path straight() { return Path({{0, 0, 0}, {300, 0, 0}}); }

Obstacle standingAt(double x, double y) {
  Obstacle obstacle;
  obstacle.id = 99;
  obstacle.position = {x, y};
  obstacle.length = 4.0;
  obstacle.width = 1.8;
  return obstacle;
}

/// Drives for some seconds. @return place and speed at the end
OnPath driven(const std::vector<Obstacle>& others, double seconds, double stop_s = kNever) {
  const Path path = straight();
  OnPath self{10.0, 8.0, 4.4, 1.8};
  for (double t = 0.0; t < seconds; t += 0.05) {
    self.speed = std::max(0.0, self.speed + 0.05 * drive(self, path, {}, others, 1, stop_s));
    self.s += 0.05 * self.speed;
  }
  return self;
}

TEST(DrivingTest, AFreeDriverKeepsItsDesiredSpeed) {
  EXPECT_NEAR(driven({}, 25.0).speed, DriverStyle{}.desired_speed_mps, 0.1);
}

TEST(DrivingTest, StopsBehindWhatStandsInItsLane) {
  const OnPath end = driven({standingAt(60.0, 0.0)}, 25.0);
  EXPECT_LT(end.speed, 0.1);
  EXPECT_LT(end.s, 60.0 - 2.0 - 2.2 - 1.0);
  EXPECT_GT(end.s, 60.0 - 2.0 - 2.2 - 4.0);
}

TEST(DrivingTest, PassesWhatStandsBesideItsLane) {
  EXPECT_GT(driven({standingAt(60.0, 3.5)}, 12.0).s, 80.0);
}

TEST(DrivingTest, BrakesForAPersonAboutToStepInFront) {
  Obstacle person = standingAt(40.0, 3.0);
  person.length = person.width = 0.6;
  person.on_foot = true;
  const OnPath self{20.0, 8.0, 4.4, 1.8};
  const double undisturbed = drive(self, straight(), {}, {}, 1, kNever);
  EXPECT_DOUBLE_EQ(drive(self, straight(), {}, {person}, 1, kNever), undisturbed);
  person.velocity = {0.0, -1.4};
  EXPECT_LT(drive(self, straight(), {}, {person}, 1, kNever), -1.0);
}

TEST(DrivingTest, WaitsAtAYieldLine) {
  const OnPath end = driven({}, 25.0, 70.0);
  EXPECT_LT(end.speed, 0.1);
  EXPECT_LT(end.s + 2.2, 70.5);
}

TEST(DrivingTest, SlowsDownForACurve) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 100; ++i) {
    points.emplace_back(12.0 * std::sin(i / 12.0), 12.0 - 12.0 * std::cos(i / 12.0), 0.0);
  }
  OnPath self{10.0, 8.0, 4.4, 1.8};
  const Path bend(points);
  EXPECT_LT(drive(self, bend, {}, {}, 1, kNever), -1.0);
  self.speed = std::sqrt(2.0 * 12.0);
  EXPECT_NEAR(drive(self, bend, {}, {}, 1, kNever), 0.0, 0.3);
}

/// A street with traffic, run without drawing.
class StreetTest : public ::testing::Test {
 protected:
  SimParams params = [] {
    SimParams busy;
    busy.traffic.vehicles = 12;
    busy.traffic.cyclists = 2;
    busy.traffic.pedestrians = 25;
    busy.traffic.road_crossing_rate_hz = 0.05;
    busy.route.shape = "straight 200, left 60 60, straight 200";
    return busy;
  }();
  Route route = makeRoute(params.route, 0.0);
  RoadNetwork network{route, 75.0, 5};
  Traffic traffic{params, route, network, Lens(params.camera).ideal(), {11, 12, 13, 14}};
  const std::vector<Actor>& vehicles = traffic.vehicles().actors();
  const std::vector<Actor>& people = traffic.pedestrians().actors();
  const RobotDriver& robot = traffic.robot();
};

TEST_F(StreetTest, KeepsItsNumbersAndGivesNoIdTwice) {
  EXPECT_EQ(people.size(), 25U);
  EXPECT_GE(vehicles.size(), 10U);
  std::map<std::int64_t, ActorKind> kinds;
  for (int i = 0; i < 600; ++i) {
    traffic.advance(0.05);
    for (const Actor& actor : traffic.actors()) {
      const auto known = kinds.emplace(actor.id, actor.kind).first;
      EXPECT_EQ(known->second, actor.kind);
    }
  }
  EXPECT_GE(people.size(), 20U);
  EXPECT_GT(kinds.size(), 39U);  // the robot moved on: others came
}

TEST_F(StreetTest, PeopleNeitherJumpNorRunAndNothingHitsTheRobot) {
  std::map<std::int64_t, Eigen::Vector2d> before;
  for (int i = 0; i < 800; ++i) {
    traffic.advance(0.05);
    const Eigen::Vector2d at = robot.T_world_robot().translation().head<2>();
    for (const Actor& actor : traffic.actors()) {
      const Eigen::Vector2d here = actor.position.head<2>();
      const bool walks = actor.kind == ActorKind::kPedestrian;
      const auto last = before.find(actor.id);
      if (last != before.end()) {
        EXPECT_LT((here - last->second).norm(), 0.05 * (walks ? 4.0 : 15.0));
      }
      before[actor.id] = here;
      EXPECT_GT((here - at).norm(), walks ? 0.8 : 1.3) << "at step " << i;
    }
  }
}

TEST(BendTest, PeoplesVelocityIsThatOfTheirMotion) {
  SimParams params;
  params.traffic.vehicles = 0;
  params.traffic.pedestrians = 30;
  params.route.kind = RouteParams::Kind::kLoop;
  params.route.loop_length_m = 44.0;
  params.route.loop_width_m = 40.0;
  params.route.corner_radius_m = 12.0;
  const Route route = makeRoute(params.route, 0.0);
  const RoadNetwork network{route, 0.0, 5};
  Traffic traffic{params, route, network, Lens(params.camera).ideal(), {11, 12, 13, 14}};
  constexpr double kStep_s = 0.05;
  std::map<std::int64_t, Eigen::Vector2d> before;
  int steps = 0, off = 0;
  for (int i = 0; i < 200; ++i) {
    traffic.advance(kStep_s);
    for (const Actor& person : traffic.pedestrians().actors()) {
      const Eigen::Vector2d here = person.position.head<2>();
      const auto last = before.find(person.id);
      if (last != before.end() && person.velocity.norm() > 0.5) {
        ++steps;
        const Eigen::Vector2d moved = (here - last->second) / kStep_s;
        off += (moved - person.velocity).norm() > 0.2 * person.velocity.norm() ? 1 : 0;
      }
      before[person.id] = here;
    }
  }
  EXPECT_GT(steps, 1000);
  EXPECT_LT(off, 0.02 * steps);
}

TEST_F(StreetTest, VehiclesDoNotDriveThroughEachOther) {
  int overlaps = 0;
  for (int i = 0; i < 800; ++i) {
    traffic.advance(0.05);
    for (std::size_t a = 0; a < vehicles.size(); ++a) {
      for (std::size_t b = a + 1; b < vehicles.size(); ++b) {
        overlaps += (vehicles[a].position - vehicles[b].position).head<2>().norm() < 1.0 ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(overlaps, 0);
}

TEST(JunctionsTest, VehiclesTurnOffToBothSides) {
  TrafficParams traffic;
  traffic.vehicles = 10;
  traffic.turning_ratio = 1.0;
  traffic.crossing_ratio = 0.0;
  RouteParams route_params;
  route_params.shape = "straight 1500";
  const Route route = makeRoute(route_params, 0.0);
  const RoadNetwork network(route, 75.0, 5);
  Vehicles vehicles(traffic, route, network, 21);
  RobotDriver robot(route_params, 0.25, false, route, 22);
  std::int64_t next_id = 0;
  vehicles.populate(robot.state(), next_id);
  std::map<std::int64_t, std::pair<double, double>> headings;  // first and last
  for (int i = 0; i < 3000; ++i) {
    std::vector<Obstacle> for_robot;
    for (const Actor& actor : vehicles.actors()) {
      headings.emplace(actor.id, std::pair(actor.yaw, 0.0)).first->second.second = actor.yaw;
      for_robot.push_back(obstacleFrom(actor));
    }
    vehicles.advance(0.05, robot.state(), {robot.state().obstacle}, next_id);
    robot.advance(0.05, for_robot);
  }
  int left = 0, right = 0;
  for (const auto& [id, heading] : headings) {
    const double turn = std::remainder(heading.second - heading.first, 2.0 * M_PI);
    left += turn > 1.4 ? 1 : 0;
    right += turn < -1.4 ? 1 : 0;
  }
  EXPECT_GE(left, 2);
  EXPECT_GE(right, 2);
}

TEST_F(StreetTest, SomeoneCrossesAndSomeoneStops) {
  bool crossed = false, stopped = false;
  for (int i = 0; i < 800; ++i) {
    traffic.advance(0.05);
    for (const Actor& actor : people) {
      const auto place = route.street.project(actor.position.head<2>(), robot.state().s - 30.0,
                                              robot.state().s + 120.0);
      crossed = crossed || std::abs(place.left) < 1.0;
      stopped = stopped || actor.speed < 0.05;
    }
  }
  EXPECT_TRUE(crossed);
  EXPECT_TRUE(stopped);
}

}  // namespace
}  // namespace headway::sim
