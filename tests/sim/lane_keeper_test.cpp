// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "driving.h"

namespace headway::sim {
namespace {

constexpr double kControlStep_s = 0.1;

Route straightStreet() {
  Route route{Path({{0, 0, 0}, {300, 0, 0}})};
  route.end_s = 300.0;
  return route;
}

Route roundStreet(double radius) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 720; ++i) {
    const double angle = i * M_PI / 360.0;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  }
  Route route{Path(points, true)};
  route.end_s = route.street.length();
  return route;
}

void drive(LaneKeeper& lane, const DriverStyle& style, const std::vector<Obstacle>& others,
           double seconds) {
  for (double t = 0.0; t < seconds; t += kControlStep_s) {
    lane.move(kControlStep_s, lane.acceleration(style, others, 1));
  }
}

TEST(LaneKeeperTest, KeepsItsDistanceFromTheMiddleOfTheStreet) {
  const Route route = roundStreet(40.0);
  LaneKeeper lane(route, 3.0);
  lane.speed = 6.0;
  for (int i = 0; i < 200; ++i) {
    lane.move(kControlStep_s, lane.acceleration({}, {}, 1));
    EXPECT_NEAR(lane.place().position.norm(), 37.0, 0.05) << "left of an anticlockwise circle";
  }
}

TEST(LaneKeeperTest, CoversGroundAtItsSpeedInEachLaneOfACurve) {
  const Route route = roundStreet(40.0);
  for (const double left : {-4.0, 0.0, 4.0}) {
    LaneKeeper lane(route, left);
    lane.speed = 5.0;
    const Eigen::Vector3d from = lane.place().position;
    lane.move(kControlStep_s, 0.0);
    EXPECT_NEAR((lane.place().position - from).norm(), 0.5, 0.01) << left;
  }
}

TEST(LaneKeeperTest, ReachesItsDesiredSpeedAndKeepsIt) {
  const Route route = straightStreet();
  LaneKeeper lane(route, -1.75);
  DriverStyle style;
  style.desired_speed_mps = 9.0;
  drive(lane, style, {}, 25.0);
  EXPECT_NEAR(lane.speed, 9.0, 0.3);
  EXPECT_LE(lane.speed, 9.0 + 1e-9);
}

TEST(LaneKeeperTest, NeverDrivesBackwards) {
  const Route route = straightStreet();
  LaneKeeper lane(route, 0.0);
  lane.s = 10.0;
  lane.speed = 0.3;
  lane.move(kControlStep_s, -7.0);
  EXPECT_EQ(lane.speed, 0.0);
  EXPECT_EQ(lane.s, 10.0);
}

TEST(LaneKeeperTest, StopsBehindAStandingVehicleInItsLaneAlone) {
  const Route route = straightStreet();
  Obstacle parked;
  parked.id = 2;
  parked.position << 60.0, -1.75;
  parked.length = 4.0;
  parked.width = 1.8;
  LaneKeeper behind(route, -1.75), beside(route, 1.75);
  behind.speed = beside.speed = 8.0;
  drive(behind, {}, {parked}, 30.0);
  drive(beside, {}, {parked}, 30.0);
  EXPECT_LT(behind.speed, 0.1);
  EXPECT_LT(behind.s + 0.5 * behind.length, 58.0);
  EXPECT_GT(behind.s + 0.5 * behind.length, 54.0);
  EXPECT_GT(beside.s, 150.0);
}

TEST(LaneKeeperTest, IsNoObstacleToItself) {
  const Route route = straightStreet();
  LaneKeeper lane(route, 0.0);
  lane.speed = 5.0;
  Obstacle self;
  self.id = 1;
  self.position << 3.0, 0.0;
  EXPECT_GT(lane.acceleration({}, {self}, 1), 0.0);
  EXPECT_LT(lane.acceleration({}, {self}, 2), 0.0);
}

}  // namespace
}  // namespace headway::sim
