// SPDX-License-Identifier: BSD-3-Clause
// Rules by which contacts of a drive are counted.
#include "contacts.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace headway::app {
namespace {

using Eigen::Vector2d;
using sim::gapBetween;

constexpr double kStep_s = 0.02;
const Vector2d kSize(0.5, 0.4);

sim::DrivenRobot robotAt(double x, double speed) {
  sim::DrivenRobot robot;
  robot.position = {x, 0.0};
  robot.motion.speed = speed;
  return robot;
}

sim::Mover personAt(const Vector2d& place, const Vector2d& velocity) {
  sim::Mover person;
  person.id = 1;
  person.parts = {{place, Vector2d::Zero(), 0.0}};
  person.radius_m = 0.25;
  person.velocity = velocity;
  return person;
}

/// Both move straight on for some seconds; the robot may stop after a while.
ContactCounts meet(double robot_x, double robot_speed, double robot_stops_s, const Vector2d& person,
                   const Vector2d& velocity, double seconds) {
  ContactCounter counter(kSize);
  double x = robot_x;
  for (double t = 0.0; t < seconds; t += kStep_s) {
    const double speed = t < robot_stops_s ? robot_speed : 0.0;
    counter.observe(robotAt(x, speed), {personAt(person + t * velocity, velocity)}, kStep_s);
    x += kStep_s * speed;
  }
  return counter.counts();
}

TEST(ContactsTest, ARobotThatDrivesIntoAStandingPersonCollidesOnce) {
  const ContactCounts counts = meet(0.0, 1.0, 10.0, {2.0, 0.0}, {0.0, 0.0}, 4.0);
  EXPECT_EQ(1u, counts.by_robot);
  EXPECT_EQ(0u, counts.by_others);
  EXPECT_EQ(0u, counts.near_misses);
  EXPECT_EQ(0.0, counts.min_distance_m);
}

TEST(ContactsTest, WhoWalksIntoAStandingRobotCollidesThemselves) {
  const ContactCounts counts = meet(0.0, 0.0, 0.0, {3.0, 0.0}, {-1.2, 0.0}, 5.0);
  EXPECT_EQ(0u, counts.by_robot);
  EXPECT_EQ(1u, counts.by_others);
}

TEST(ContactsTest, WhoRunsIntoARobotFromBehindCollidesThemselves) {
  const ContactCounts counts = meet(0.0, 0.5, 10.0, {-2.0, 0.0}, {1.5, 0.0}, 3.0);
  EXPECT_EQ(0u, counts.by_robot);
  EXPECT_EQ(1u, counts.by_others);
}

TEST(ContactsTest, ARobotThatStopsWithinABrakingDistanceIsAtFault) {
  // A walker at 1.5 m/s needs 0.45 m: the robot's front stops 0.3 m before their body.
  const ContactCounts late = meet(0.0, 1.0, 1.0, {3.05, 0.0}, {-1.5, 0.0}, 3.0);
  EXPECT_EQ(1u, late.by_robot);
  // It stops a metre before: they had the room to stop.
  const ContactCounts early = meet(0.0, 1.0, 0.5, {3.0, 0.0}, {-1.5, 0.0}, 3.0);
  EXPECT_EQ(0u, early.by_robot);
  EXPECT_EQ(1u, early.by_others);
}

TEST(ContactsTest, PassingCloseByIsANearMissOnce) {
  const ContactCounts counts = meet(0.0, 1.0, 10.0, {2.0, 0.6}, {0.0, 0.0}, 4.0);
  EXPECT_EQ(0u, counts.by_robot + counts.by_others);
  EXPECT_EQ(1u, counts.near_misses);
  EXPECT_NEAR(0.15, counts.min_distance_m, 0.01);
  EXPECT_EQ(0u, meet(0.0, 1.0, 10.0, {2.0, 0.8}, {0.0, 0.0}, 4.0).near_misses);
}

TEST(ContactsTest, WhoPassesAStandingRobotIsNoNearMiss) {
  EXPECT_EQ(0u, meet(0.0, 0.0, 0.0, {2.0, 0.6}, {-1.0, 0.0}, 4.0).near_misses);
}

TEST(ContactsTest, BesideTheForksOfAForkliftIsNoContact) {
  sim::Mover forklift;
  forklift.parts = {{{-0.5, 0.0}, {2.2, 1.15}, 0.0}, {{1.1, 0.0}, {1.0, 0.62}, 0.0}};
  const auto touches = [&](double x, double y) {
    ContactCounter counter(kSize);
    sim::DrivenRobot robot = robotAt(x, 0.5);
    robot.position.y() = y;
    robot.yaw = M_PI;
    counter.observe(robot, {forklift}, kStep_s);
    return counter.counts().by_robot;
  };
  EXPECT_EQ(0u, touches(1.2, 0.53));
  EXPECT_EQ(1u, touches(1.2, 0.5)) << "on a fork";
  EXPECT_EQ(1u, touches(0.84, 0.53)) << "at its body";
}

TEST(ContactsTest, PushingAgainstAThingCountsOnce) {
  ContactCounter counter(kSize);
  sim::DrivenRobot robot = robotAt(0.0, 0.1);
  robot.bumped = true;
  for (int i = 0; i < 200; ++i) counter.observe(robot, {}, kStep_s);
  EXPECT_EQ(1u, counter.counts().with_things);
  robot.bumped = false;
  for (int i = 0; i < 100; ++i) counter.observe(robot, {}, kStep_s);
  robot.bumped = true;
  counter.observe(robot, {}, kStep_s);
  EXPECT_EQ(2u, counter.counts().with_things);
}

TEST(ContactsTest, ABrakingZoneGrowsWithTheSquareOfTheSpeed) {
  EXPECT_EQ(0.0, brakingZone({{1.0, 2.0}, Vector2d::Zero(), 0.0}, {0.0, 0.0}).size.norm());
  const sim::Footprint person{{0.0, 0.0}, Vector2d::Zero(), 0.0};
  const sim::Footprint slow = brakingZone(person, {0.0, 1.0});
  const sim::Footprint fast = brakingZone(person, {0.0, 2.0});
  EXPECT_NEAR(0.2, slow.size.x(), 1e-9);
  EXPECT_NEAR(0.8, fast.size.x(), 1e-9);
  EXPECT_LT((slow.centre - Vector2d(0.0, 0.1)).norm(), 1e-9) << "it lies ahead";
}

TEST(ContactsTest, TurningOnTheSpotApproachesWithACorner) {
  sim::DrivenRobot robot = robotAt(0.0, 0.0);
  robot.motion.turn_rate = 1.0;
  const sim::Footprint aside{{0.25, 0.5}, Vector2d::Zero(), 0.0};  // above the front left corner
  EXPECT_GT(approachSpeed(robot, kSize, aside), 0.1);
  robot.motion.turn_rate = -1.0;
  EXPECT_LT(approachSpeed(robot, kSize, aside), -0.1);
}

TEST(ContactsTest, GapsOfRectanglesAreThoseOfTheirNearestPoints) {
  const sim::Footprint box{{0.0, 0.0}, {2.0, 1.0}, 0.0};
  EXPECT_NEAR(1.0, gapBetween(box, {{3.0, 0.0}, {2.0, 1.0}, 0.0}), 1e-9);
  EXPECT_NEAR(std::sqrt(2.0), gapBetween(box, {{3.0, 2.0}, {2.0, 1.0}, 0.0}), 1e-9);
  EXPECT_EQ(0.0, gapBetween(box, {{1.5, 0.0}, {2.0, 0.1}, 0.7}));
  EXPECT_EQ(0.0, gapBetween({{0.0, 0.0}, {4.0, 0.1}, 0.0}, {{0.0, 0.0}, {0.1, 4.0}, 0.0}))
      << "a cross has no corner inside the other";
  EXPECT_NEAR(2.0 - std::sqrt(0.5),
              gapBetween({{0.0, 0.0}, {1.0, 1.0}, M_PI / 4}, {{2.0, 0.0}, Vector2d::Zero(), 0.0}),
              1e-9);
}

}  // namespace
}  // namespace headway::app
