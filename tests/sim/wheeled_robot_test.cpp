// SPDX-License-Identifier: BSD-3-Clause
// Laws of the robot's motion on an empty floor.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "attitude.h"
#include "robot.h"
#include "site.h"

namespace headway::sim {
namespace {

constexpr double kStep = 0.01;  // [s]

/// A floor of 20 m x 6 m with stops at its ends.
struct Floor {
  Floor() {
    site.area = rectangle(0, 0, 20, 6);
    site.robot_stops = {{2, 3}, {9, 3}, {16, 3}};
    params.route.speed_mps = 1.2;
    params.camera.ride_deg = 0.0;
    params.robot.sudden_stop_rate_hz = 0.0;
  }
  WheeledRobot& robot(std::uint64_t seed = 1) {
    grid = std::make_unique<NavigationGrid>(site);
    made = std::make_unique<WheeledRobot>(params, site, *grid, seed);
    return *made;
  }
  Site site;
  SimParams params;
  std::unique_ptr<NavigationGrid> grid;
  std::unique_ptr<WheeledRobot> made;
};

struct Motion {
  double time = 0.0;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double speed = 0.0, turn_rate = 0.0;
  Pose pose = Pose::Identity();
};

/// The robot's motion on its way, with the obstacles that `others` names at each time.
template <typename Others>
std::vector<Motion> drive(WheeledRobot& robot, double seconds, const Others& others) {
  std::vector<Motion> motions;
  Pose last = robot.T_world_robot();
  for (int i = 1; i * kStep < seconds; ++i) {
    robot.advance(kStep, others(i * kStep));
    const Pose now = robot.T_world_robot();
    Motion motion;
    motion.time = i * kStep;
    motion.at = robot.position();
    motion.speed = robot.obstacle().velocity.norm();
    motion.turn_rate = wrapAngle(yawOf(now) - yawOf(last)) / kStep;
    motion.pose = now;
    motions.push_back(motion);
    last = now;
  }
  return motions;
}

std::vector<Motion> drive(WheeledRobot& robot, double seconds) {
  return drive(robot, seconds, [](double) { return std::vector<Obstacle>(); });
}

Obstacle personAt(const Eigen::Vector2d& at) {
  Obstacle person;
  person.id = 4;
  person.position = at;
  person.on_foot = true;
  return person;
}

TEST(WheeledRobotTest, StartsAtTheFirstStopTurnedAsideFromItsWay) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Floor floor;
    const WheeledRobot& robot = floor.robot(seed);
    EXPECT_EQ(robot.position(), floor.site.robot_stops.front());
    const Eigen::Vector2d to = robot.ahead(0.5) - robot.position();
    const double aside =
        std::abs(wrapAngle(std::atan2(to.y(), to.x()) - yawOf(robot.T_world_robot())));
    EXPECT_GT(aside, 0.65) << seed;
    EXPECT_LT(aside, 1.55) << seed;
  }
}

TEST(WheeledRobotTest, AcceleratesAndBrakesAsItsParametersSay) {
  Floor floor;
  floor.params.robot.acceleration_mps2 = 0.8;
  const auto motions = drive(floor.robot(), 30.0);
  double before = 0.0, hardest_start = 0.0, hardest_brake = 0.0, top = 0.0;
  for (const Motion& motion : motions) {
    hardest_start = std::max(hardest_start, (motion.speed - before) / kStep);
    hardest_brake = std::max(hardest_brake, (before - motion.speed) / kStep);
    top = std::max(top, motion.speed);
    before = motion.speed;
  }
  EXPECT_NEAR(hardest_start, 0.8, 1e-6);
  EXPECT_LE(hardest_brake, 2.0 + 1e-6) << "nothing is in its way: it brakes comfortably";
  EXPECT_NEAR(top, 1.2, 1e-6);
}

TEST(WheeledRobotTest, TurnsOnTheSpotNoFasterThanItMay) {
  Floor floor;
  floor.params.robot.turn_rate_dps = 45.0;
  double fastest = 0.0, fastest_while_driving = 0.0;
  for (const Motion& motion : drive(floor.robot(), 60.0)) {
    fastest = std::max(fastest, std::abs(motion.turn_rate));
    if (motion.speed > 0.5) {
      fastest_while_driving = std::max(fastest_while_driving, std::abs(motion.turn_rate));
    }
  }
  EXPECT_NEAR(fastest, 45.0 * M_PI / 180.0, 1e-3);
  EXPECT_LE(fastest_while_driving, 0.5 * fastest + 1e-6) << "it turns round at a standstill";
}

TEST(WheeledRobotTest, DrivesFromStopToStop) {
  Floor floor;
  std::vector<bool> visited(3, false);
  for (const Motion& motion : drive(floor.robot(), 120.0)) {
    for (std::size_t i = 0; i < 3; ++i) {
      if ((motion.at - floor.site.robot_stops[i]).norm() < 0.2) visited[i] = true;
    }
    EXPECT_NEAR(motion.at.y(), 3.0, 0.5) << "straight along the floor";
  }
  EXPECT_EQ(std::count(visited.begin(), visited.end(), true), 3);
}

TEST(WheeledRobotTest, StopsBeforeAPersonAndGoesOnWhenTheyAreGone) {
  Floor floor;
  const Eigen::Vector2d standing(6.0, 3.0);
  const auto motions = drive(floor.robot(), 12.0, [&](double time) {
    return time < 8.0 ? std::vector<Obstacle>{personAt(standing)} : std::vector<Obstacle>{};
  });
  double nearest = 1e9, farthest = 0.0;
  for (const Motion& motion : motions) {
    if (motion.time < 8.0) nearest = std::min(nearest, (motion.at - standing).norm());
    if (motion.time < 8.0) {
      EXPECT_LT(motion.at.x(), standing.x());
    }
    farthest = std::max(farthest, motion.at.x());
  }
  EXPECT_GT(nearest, 0.4);
  EXPECT_LT(nearest, 1.5) << "but it came";
  EXPECT_GT(farthest, 6.5);
}

TEST(WheeledRobotTest, BrakesHardForWhoStepsInFrontOfIt) {
  Floor floor;
  floor.params.robot.brake_mps2 = 3.0;
  WheeledRobot& robot = floor.robot();
  double before = 0.0, hardest = 0.0;
  bool stepped = false;
  for (int i = 0; i < 1500; ++i) {
    const double yaw = yawOf(robot.T_world_robot());
    const Eigen::Vector2d ahead =
        robot.position() + 0.7 * Eigen::Vector2d(std::cos(yaw), std::sin(yaw));
    stepped = stepped || before > 1.1;
    robot.advance(kStep,
                  stepped ? std::vector<Obstacle>{personAt(ahead)} : std::vector<Obstacle>{});
    const double speed = robot.obstacle().velocity.norm();
    hardest = std::max(hardest, (before - speed) / kStep);
    before = speed;
  }
  EXPECT_TRUE(stepped);
  EXPECT_NEAR(hardest, 3.0, 1e-6);
  EXPECT_EQ(before, 0.0);
}

TEST(WheeledRobotTest, IgnoresWhoStandsBesideItsWay) {
  Floor floor;
  double farthest = 0.0;
  const auto beside = [](double) { return std::vector<Obstacle>{personAt({5.5, 3.9})}; };
  for (const Motion& motion : drive(floor.robot(), 12.0, beside)) {
    farthest = std::max(farthest, motion.at.x());
  }
  EXPECT_GT(farthest, 8.0);
}

TEST(WheeledRobotTest, StopsWithoutCauseAsOftenAsAsked) {
  Floor floor;
  floor.params.robot.sudden_stop_rate_hz = 0.5;
  floor.params.robot.brake_mps2 = 4.0;
  double before = 0.0, driven = 0.0;
  int stops = 0;
  bool braking = false;
  for (const Motion& motion : drive(floor.robot(), 1000.0)) {
    const bool hard = (before - motion.speed) / kStep > 3.9;
    stops += hard && !braking ? 1 : 0;
    braking = hard;
    if (motion.speed > 0.3 && !hard) driven += kStep;
    before = motion.speed;
  }
  EXPECT_NEAR(stops / driven, 0.5, 0.12);
}

TEST(WheeledRobotTest, BumpsOverAThresholdWithFrontAndRearWheels) {
  Floor floor;
  SiteBuilder(floor.site).threshold({5.5, 3.0}, 0.0, 6.0, 0.012);
  double highest = 0.0, up = 0.0, down = 0.0;
  for (const Motion& motion : drive(floor.robot(), 12.0)) {
    if (std::abs(motion.at.x() - 5.5) > 1.0 || motion.speed < 0.3) continue;
    highest = std::max(highest, motion.pose.translation().z());
    up = std::min(up, pitchOf(motion.pose));
    down = std::max(down, pitchOf(motion.pose));
  }
  EXPECT_NEAR(highest, 0.006, 1e-3) << "one axle at a time: half of the height";
  EXPECT_NEAR(-up, std::atan(0.012 / 0.34), 0.012);  // nose up, then down; and it nods
  EXPECT_NEAR(down, std::atan(0.012 / 0.34), 0.012);
}

TEST(WheeledRobotTest, NodsForwardAsItBrakes) {
  Floor floor;
  double lowest = 0.0, highest = 0.0, before = 0.0;
  for (const Motion& motion : drive(floor.robot(), 12.0)) {
    const double pitch = pitchOf(motion.pose);
    if (motion.speed < before - 1e-9) highest = std::max(highest, pitch);
    if (motion.speed > before + 1e-9) lowest = std::min(lowest, pitch);
    before = motion.speed;
    EXPECT_NEAR(rollOf(motion.pose), 0.0, 1e-9);
  }
  EXPECT_GT(highest, 0.001) << "positive pitch is nose down";
  EXPECT_LT(lowest, -0.001);
  EXPECT_LT(highest, 0.03);
}

TEST(WheeledRobotTest, LeansWhereOneWheelIsLower) {
  Floor floor;
  SiteBuilder builder(floor.site);
  // Falls by 5 % to the south over the whole floor.
  builder.slope({{0, 6, 0.15}, {20, 6, 0.15}, {20, 0, -0.15}, {0, 0, -0.15}}, Material::kConcrete);
  for (const Motion& motion : drive(floor.robot(), 10.0)) {
    const double yaw = yawOf(motion.pose);
    EXPECT_NEAR(rollOf(motion.pose), std::atan(0.05) * std::cos(yaw), 2e-3);
    if (motion.speed == 0.0) continue;
    EXPECT_NEAR(motion.pose.translation().z(), 0.05 * (motion.at.y() - 3.0), 1e-3);
  }
}

TEST(WheeledRobotTest, AheadLiesOnItsWay) {
  Floor floor;
  const WheeledRobot& robot = floor.robot();
  for (const double distance : {0.5, 1.5, 4.0}) {
    const Eigen::Vector2d place = robot.ahead(distance);
    EXPECT_NEAR((place - robot.position()).norm(), distance, 0.1);
    EXPECT_GT(place.x(), robot.position().x());
  }
  const Eigen::Vector2d end = robot.ahead(1000.0);
  const auto& stops = floor.site.robot_stops;
  EXPECT_TRUE(std::any_of(stops.begin(), stops.end(),
                          [&](const auto& stop) { return (stop - end).norm() < 1e-9; }));
}

TEST(WheeledRobotTest, AStandingRobotStaysWhateverComes) {
  Floor floor;
  floor.params.robot.standing = true;
  WheeledRobot& robot = floor.robot();
  const Pose first = robot.T_world_robot();
  for (const Motion& motion : drive(robot, 5.0)) {
    EXPECT_EQ(motion.pose.matrix(), first.matrix());
    EXPECT_EQ(motion.speed, 0.0);
  }
}

TEST(WheeledRobotTest, LooksForAnotherWayWhenItIsBlockedForLong) {
  Floor floor;
  floor.site.robot_stops = {{9, 3}, {16, 3}, {2, 3}};
  WheeledRobot& robot = floor.robot();
  const double first = robot.ahead(3.0).x() - 9.0;
  // Somebody always stands in the way on that side.
  bool other_side = false;
  for (const Motion& motion : drive(robot, 60.0, [&](double) {
         return std::vector<Obstacle>{personAt({9.0 + std::copysign(1.3, first), 3.0})};
       })) {
    other_side = other_side || (motion.at.x() - 9.0) * first < -2.0 * std::abs(first) / 3.0;
  }
  EXPECT_TRUE(other_side);
}

TEST(WheeledRobotTest, RepeatsATourThatEndsAtItsStart) {
  Floor floor;
  floor.params.robot.tour_stops = 2;
  WheeledRobot& robot = floor.robot(3);
  const Eigen::Vector2d start = robot.position();
  std::vector<Eigen::Vector2d> stops;
  for (const Motion& motion : drive(robot, 150.0)) {
    const bool stands = motion.speed < 1e-9 && std::abs(motion.turn_rate) < 1e-9;
    if (stands && (stops.empty() || (stops.back() - motion.at).norm() > 1.0)) {
      stops.push_back(motion.at);
    }
  }
  ASSERT_GE(stops.size(), 7U) << "twice around, from the start";
  for (std::size_t i = 0; i + 3 < stops.size(); ++i) {
    EXPECT_LT((stops[i + 3] - stops[i]).norm(), 0.3) << "stop " << i;
  }
  EXPECT_LT((stops[3] - start).norm(), 0.3);
}

}  // namespace
}  // namespace headway::sim
