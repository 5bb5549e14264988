// SPDX-License-Identifier: BSD-3-Clause
// Laws of people who walk on an empty floor around a robot.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "site.h"
#include "site_traffic.h"

namespace headway::sim {
namespace {

/// A robot too far away to matter.
const Obstacle kNoRobot{-1, {1e4, 1e4}, {0.0, 0.0}, 0.0, 1.0, 1.0, false};

constexpr double kWalkStep = 0.02;  // [s]

/// A floor of 16 m x 12 m with destinations at its corners and a robot that stands in the middle.
struct WalkersFloor {
  WalkersFloor() {
    site.area = rectangle(0, 0, 16, 12);
    site.robot_stops = {{8, 6}, {14, 6}};
    site.destinations = {{2, 2}, {14, 2}, {14, 10}, {2, 10}};
    params.robot.standing = true;
    params.camera.ride_deg = 0.0;
    params.traffic.pedestrians = 6;
    params.traffic.stop_rate_hz = 0.0;
    params.traffic.encounter_ratio = 0.0;
  }
  void make(std::uint64_t seed = 1) {
    grid = std::make_unique<NavigationGrid>(site);
    robot = std::make_unique<WheeledRobot>(params, site, *grid, 1);
    walkers = std::make_unique<Walkers>(params.traffic, site, *grid, seed);
    walkers->populate(*robot, next_id);
  }
  void advance() { walkers->advance(kWalkStep, *robot, {}); }
  [[nodiscard]] const std::vector<Actor>& people() const { return walkers->actors(); }

  Site site;
  SimParams params;
  std::int64_t next_id = 10;
  std::unique_ptr<NavigationGrid> grid;
  std::unique_ptr<WheeledRobot> robot;
  std::unique_ptr<Walkers> walkers;
};

TEST(WalkersTest, AsManyComeAsAskedForWithIdsOfTheirOwn) {
  WalkersFloor floor;
  floor.site.spots = {{{3, 6}, 0.0, true}, {{5, 9}, 1.0, false}, {{12, 3}, 0.0, true}};
  floor.params.traffic.idle_people = 2;
  floor.make();
  ASSERT_EQ(floor.people().size(), 8U);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(floor.people()[i].id, 10 + static_cast<std::int64_t>(i));
    EXPECT_TRUE(isPerson(floor.people()[i].kind));
    EXPECT_GT((floor.people()[i].position.head<2>() - floor.robot->position()).norm(), 1.8);
  }
  EXPECT_EQ(floor.next_id, 18);
}

TEST(WalkersTest, OnlyAsManySitOrStandAboutAsThereArePlaces) {
  WalkersFloor floor;
  floor.site.spots = {{{3, 6}, 0.4, true}, {{5, 9}, 1.0, false}};
  floor.params.traffic.idle_people = 5;
  floor.params.traffic.pedestrians = 0;
  floor.make();
  ASSERT_EQ(floor.people().size(), 2U);
  const auto before = floor.people();
  for (int i = 0; i < 200; ++i) floor.advance();
  for (std::size_t i = 0; i < 2; ++i) {
    const Actor& person = floor.people()[i];
    EXPECT_EQ(person.position, before[i].position);
    EXPECT_EQ(person.yaw, before[i].yaw);
    const bool seated = person.position.x() < 4.0;
    EXPECT_EQ(person.kind, seated ? ActorKind::kSeatedPerson : ActorKind::kPedestrian);
    EXPECT_NEAR(person.yaw, seated ? 0.4 : 1.0, seated ? 1e-9 : 0.41);
  }
}

TEST(WalkersTest, VariedBodiesWalkTheSameWays) {
  WalkersFloor usual, varied;
  varied.params.traffic.varied_bodies = true;
  usual.make();
  varied.make();
  ASSERT_EQ(usual.people().size(), varied.people().size());
  bool differ = false;
  for (std::size_t i = 0; i < usual.people().size(); ++i) {
    EXPECT_EQ(usual.people()[i].position, varied.people()[i].position);
    differ = differ || usual.people()[i].size != varied.people()[i].size;
  }
  EXPECT_TRUE(differ);
}

TEST(WalkersTest, SpeedsSpreadAboutTheMeanAskedFor) {
  WalkersFloor floor;
  floor.site.area = rectangle(0, 0, 40, 40);
  floor.site.destinations = {{3, 3}, {37, 3}, {37, 37}, {3, 37}, {20, 36}, {36, 20}};
  floor.params.traffic.pedestrians = 40;
  floor.params.traffic.walking_speed_mps = 1.3;
  floor.make();
  std::vector<double> fastest(40, 0.0);
  for (int i = 0; i < 600; ++i) {
    floor.advance();
    for (std::size_t k = 0; k < 40; ++k) {
      fastest[k] = std::max(fastest[k], floor.people()[k].speed);
      EXPECT_LE(floor.people()[k].speed, 1.25 * 2.0 + 0.01);
    }
  }
  double mean = 0.0, square = 0.0;
  for (const double speed : fastest) mean += speed / 40.0;
  for (const double speed : fastest) square += std::pow(speed - mean, 2) / 40.0;
  EXPECT_NEAR(mean, 1.3, 0.25);
  EXPECT_GT(std::sqrt(square), 0.1);
  EXPECT_LT(std::sqrt(square), 0.45);
}

TEST(WalkersTest, AccelerationsAreThoseOfPeople) {
  WalkersFloor floor;
  floor.make();
  std::vector<Eigen::Vector2d> before;
  for (const Actor& person : floor.people()) before.push_back(person.velocity);
  for (int i = 0; i < 1500; ++i) {
    floor.advance();
    for (std::size_t k = 0; k < before.size(); ++k) {
      const Eigen::Vector2d change = floor.people()[k].velocity - before[k];
      // A blocked walker stops at once; walkers start with at most 2.5 m/s^2.
      const double gain = floor.people()[k].velocity.norm() - before[k].norm();
      EXPECT_LE(gain, 2.5 * kWalkStep + 1e-9);
      if (change.norm() > 2.5 * kWalkStep + 1e-9) {
        EXPECT_LT(gain, 0.0);
      }
      before[k] = floor.people()[k].velocity;
    }
  }
}

TEST(WalkersTest, PassTheRobotAtTheirDistance) {
  WalkersFloor floor;
  floor.params.traffic.pedestrians = 10;
  floor.params.traffic.encounter_ratio = 0.8;
  floor.make();
  double nearest = 1e9;
  for (int i = 0; i < 4000; ++i) {
    floor.advance();
    for (const Actor& person : floor.people()) {
      nearest = std::min(nearest, (person.position.head<2>() - floor.robot->position()).norm());
    }
  }
  EXPECT_GE(nearest, 0.58 - 1e-6);
  EXPECT_LE(nearest, 0.75) << "and somebody comes that near";
}

TEST(WalkersTest, DoNotWalkThroughEachOther) {
  WalkersFloor floor;
  floor.params.traffic.pedestrians = 12;
  floor.make();
  int overlaps = 0, pairs = 0;
  for (int i = 0; i < 2000; ++i) {
    floor.advance();
    for (std::size_t a = 0; a < floor.people().size(); ++a) {
      for (std::size_t b = a + 1; b < floor.people().size(); ++b, ++pairs) {
        const double distance =
            (floor.people()[a].position - floor.people()[b].position).head<2>().norm();
        overlaps += distance < 0.3 ? 1 : 0;
      }
    }
  }
  EXPECT_LT(overlaps, 1e-3 * pairs) << "but for crowds at a destination";
}

TEST(WalkersTest, FaceTheWayTheyWalkAndStepWithTheirSpeed) {
  WalkersFloor floor;
  floor.params.traffic.pedestrians = 1;
  floor.make(3);
  double gait = floor.people()[0].gait, way = 0.0;
  const double first = gait;
  int aligned = 0, walking = 0;
  for (int i = 0; i < 1000; ++i) {
    floor.advance();
    const Actor& person = floor.people()[0];
    EXPECT_GE(person.gait, gait);
    gait = person.gait;
    way += person.speed * kWalkStep;
    if (person.speed < 0.8) continue;
    ++walking;
    const double heading = std::atan2(person.velocity.y(), person.velocity.x());
    aligned += std::abs(wrapAngle(heading - person.yaw)) < 0.3 ? 1 : 0;
  }
  EXPECT_GT(aligned, 0.9 * walking);
  EXPECT_NEAR(2.0 * M_PI * way / (gait - first), 1.35, 0.3) << "metres for a double step";
}

TEST(WalkersTest, StopAsOftenAsAskedAndWaitForAWhile) {
  WalkersFloor floor;
  floor.params.traffic.pedestrians = 8;
  floor.params.traffic.stop_rate_hz = 0.2;
  floor.make();
  double standing = 0.0, total = 0.0;
  for (int i = 0; i < 3000; ++i) {
    floor.advance();
    for (const Actor& person : floor.people()) {
      standing += person.speed < 0.05 ? kWalkStep : 0.0;
      total += kWalkStep;
    }
  }
  // 2.5 s at every 5 s of walking, and up to 3 s at each destination.
  EXPECT_GT(standing / total, 0.2);
  EXPECT_LT(standing / total, 0.6);
}

TEST(WalkersTest, GoRoundAWallToTheOtherSide) {
  WalkersFloor floor;
  SiteBuilder(floor.site).wall({8, 2}, {8, 12}, 2.8, Material::kPlaster);
  floor.site.robot_stops = {{4, 1}, {12, 1}};
  floor.params.traffic.pedestrians = 5;
  floor.make();
  std::vector<int> sides(floor.people().size(), 0);
  for (int i = 0; i < 4000; ++i) {
    floor.advance();
    for (std::size_t k = 0; k < sides.size(); ++k) {
      const Eigen::Vector2d at = floor.people()[k].position.head<2>();
      sides[k] |= at.x() < 7.0 ? 1 : (at.x() > 9.0 ? 2 : 0);
      EXPECT_GT(floor.grid->clearance(at), 0.2);
    }
  }
  EXPECT_GE(std::count(sides.begin(), sides.end(), 3), 3);
}

TEST(WalkersTest, StepAsideForAVehicle) {
  WalkersFloor floor;
  floor.params.traffic.pedestrians = 6;
  floor.make();
  Obstacle forklift;
  forklift.id = 3;
  forklift.position = {5.0, 4.0};
  forklift.length = 3.0;
  forklift.width = 1.2;
  int inside = 0, near = 0;
  for (int i = 0; i < 4000; ++i) {
    floor.walkers->advance(kWalkStep, *floor.robot, {forklift});
    for (const Actor& person : floor.people()) {
      const double distance = (person.position.head<2>() - forklift.position).norm();
      inside += i > 200 && distance < 0.5 ? 1 : 0;
      near += distance < 3.0 ? 1 : 0;
    }
  }
  EXPECT_GT(near, 0);
  EXPECT_LT(inside, 0.05 * near);
}

/// A rectangle of 20 m x 10 m.
VehicleLoop loopOf(ActorKind kind, double speed) {
  VehicleLoop loop{kind, {}, speed};
  for (int i = 0; i < 20; ++i) loop.points.emplace_back(i, 0, 0);
  for (int i = 0; i < 10; ++i) loop.points.emplace_back(20, i, 0);
  for (int i = 20; i > 0; --i) loop.points.emplace_back(i, 10, 0);
  for (int i = 10; i > 0; --i) loop.points.emplace_back(0, i, 0);
  return loop;
}

struct Loops {
  explicit Loops(int vehicle_count, int cyclist_count = 0) {
    site.loops = {loopOf(ActorKind::kForklift, 2.0), loopOf(ActorKind::kCyclist, 4.0)};
    params.vehicles = vehicle_count;
    params.cyclists = cyclist_count;
  }
  Site site;
  TrafficParams params;
  std::int64_t next_id = 0;
};

TEST(LoopVehiclesTest, EachKindKeepsToItsLoopInTheNumbersAskedFor) {
  Loops loops(2, 3);
  const LoopVehicles vehicles(loops.params, loops.site, kNoRobot, 5, loops.next_id);
  const auto count = [&](ActorKind kind) {
    return std::count_if(vehicles.actors().begin(), vehicles.actors().end(),
                         [&](const Actor& actor) { return actor.kind == kind; });
  };
  EXPECT_EQ(count(ActorKind::kForklift), 2);
  EXPECT_EQ(count(ActorKind::kCyclist), 3);
  EXPECT_EQ(loops.next_id, 5);
}

TEST(LoopVehiclesTest, GoRoundNearTheirSpeedAndFaceTheirWay) {
  Loops loops(1);
  LoopVehicles vehicles(loops.params, loops.site, kNoRobot, 5, loops.next_id);
  Eigen::Vector3d before = vehicles.actors()[0].position;
  double way = 0.0, fastest = 0.0;
  for (int i = 0; i < 3000; ++i) {
    vehicles.advance(kWalkStep, {});
    const Actor& actor = vehicles.actors()[0];
    const Eigen::Vector3d step = actor.position - before;
    way += step.norm();
    fastest = std::max(fastest, actor.speed);
    EXPECT_NEAR((step.head<2>() / kWalkStep - actor.velocity).norm(), 0.0,
                0.1 * actor.speed + 1e-9);
    if (actor.speed > 0.5) {
      EXPECT_GT(step.head<2>().normalized().dot(actor.velocity.normalized()), 0.95);
    }
    before = actor.position;
  }
  EXPECT_GT(way, 60.0) << "more than once round";
  EXPECT_NEAR(fastest, 2.0, 0.35);
}

TEST(LoopVehiclesTest, BrakeForWhoStandsInTheirWay) {
  Loops loops(1);
  LoopVehicles vehicles(loops.params, loops.site, kNoRobot, 5, loops.next_id);
  Obstacle person;
  person.id = 77;
  person.position = {10.0, 0.0};
  person.length = person.width = 0.5;
  person.on_foot = true;
  double nearest = 1e9;
  for (int i = 0; i < 3000; ++i) {
    vehicles.advance(kWalkStep, {person});
    nearest = std::min(nearest, (vehicles.actors()[0].position.head<2>() - person.position).norm());
  }
  EXPECT_LT(vehicles.actors()[0].speed, 0.1);
  EXPECT_GT(nearest, 1.6 + 0.3);
  EXPECT_LT(nearest, 5.0);
}

TEST(LoopVehiclesTest, SpreadRoundTheLoopAndDoNotRunIntoEachOther) {
  Loops loops(3);
  LoopVehicles vehicles(loops.params, loops.site, kNoRobot, 6, loops.next_id);
  for (int i = 0; i < 3000; ++i) {
    vehicles.advance(kWalkStep, {});
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = a + 1; b < 3; ++b) {
        EXPECT_GT((vehicles.actors()[a].position - vehicles.actors()[b].position).norm(), 2.5);
      }
    }
  }
}

}  // namespace
}  // namespace headway::sim
