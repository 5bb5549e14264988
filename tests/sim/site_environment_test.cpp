// SPDX-License-Identifier: BSD-3-Clause
// Laws of motion in hall, campus and warehouse: no object passes through another.
#include "site_environment.h"

#include <gtest/gtest.h>
#include <headway_test/repeats.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "robot_sensors.h"

namespace headway::sim {
namespace {

using Kind = WorldParams::Kind;

constexpr double kPeopleStep = 0.02;  // [s]
constexpr int kSeeds = test::repeats(3, 1);
constexpr std::array kKinds = {Kind::kWarehouse, Kind::kHall, Kind::kCampus};

SimParams busy(Kind kind, int seed) {
  SimParams params;
  params.world.kind = kind;
  params.world.seed = seed;
  params.route.speed_mps = 1.0;
  params.traffic.pedestrians = 14;
  params.traffic.idle_people = 4;
  params.traffic.vehicles = kind == Kind::kHall ? 0 : 3;
  params.traffic.cyclists = kind == Kind::kCampus ? 3 : 0;
  params.traffic.walking_speed_mps = 1.2;
  params.traffic.stop_rate_hz = 0.06;
  return params;
}

/// What happens in a minute.
struct Minute {
  double nearest_person = 1e9;      ///< to the robot, middle to middle [m]
  double nearest_walker_speed = 0;  ///< of the one who came nearest [m/s]
  double person_clearance = 1e9;    ///< lowest, to obstacles [m]
  double robot_clearance = 1e9;     ///< the same of the robot [m]
  double turn_rate = 0.0;           ///< highest [rad/s]
  double brake = 0.0;               ///< highest [m/s^2]
  double path = 0.0;                ///< [m]
  double walked = 0.0;              ///< by all people together [m]
  bool left_floor = false;
};

Minute watch(const SimParams& params, double seconds) {
  SiteEnvironment place(params, {});
  Minute minute;
  Pose last = place.T_world_robot();
  double speed = 0.0;
  for (double t = 0.0; t < seconds; t += kPeopleStep) {
    place.advance(kPeopleStep);
    const Pose now = place.T_world_robot();
    const Eigen::Vector2d robot = now.translation().head<2>();
    const double way = (robot - last.translation().head<2>()).norm();
    minute.path += way;
    minute.brake = std::max(minute.brake, (speed - way / kPeopleStep) / kPeopleStep);
    speed = way / kPeopleStep;
    minute.turn_rate =
        std::max(minute.turn_rate, std::abs(wrapAngle(yawOf(now) - yawOf(last))) / kPeopleStep);
    minute.robot_clearance = std::min(minute.robot_clearance, place.grid().clearance(robot));
    for (const Actor& actor : place.actors(100.0)) {
      if (actor.kind != ActorKind::kPedestrian) continue;
      const Eigen::Vector2d at = actor.position.head<2>();
      minute.walked += actor.speed * kPeopleStep;
      if ((at - robot).norm() < minute.nearest_person) {
        minute.nearest_person = (at - robot).norm();
        minute.nearest_walker_speed = actor.speed;
      }
      if (actor.speed > 0.0) {
        minute.person_clearance = std::min(minute.person_clearance, place.grid().clearance(at));
      }
      minute.left_floor = minute.left_floor || !place.site().area.contains(at);
    }
    last = now;
  }
  return minute;
}

class SiteEnvironmentTest : public ::testing::TestWithParam<Kind> {};

TEST_P(SiteEnvironmentTest, PeoplePassThroughNeitherWallsNorTheRobot) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const Minute minute = watch(busy(GetParam(), seed), 60.0);
    EXPECT_GT(minute.person_clearance, 0.2) << "seed " << seed;
    EXPECT_GT(minute.robot_clearance, 0.2) << "seed " << seed;
    EXPECT_GT(minute.nearest_person, 0.5) << "seed " << seed;
    EXPECT_FALSE(minute.left_floor) << "seed " << seed;
    EXPECT_GT(minute.path, 8.0) << "seed " << seed;  // it gets on
    EXPECT_GT(minute.walked, 14 * 60.0 * 0.3) << "seed " << seed;
  }
}

TEST_P(SiteEnvironmentTest, TheRobotTurnsOnTheSpotAsFastAsItMayAndBrakesHard) {
  SimParams params = busy(GetParam(), 4);
  params.robot.sudden_stop_rate_hz = 0.1;
  const Minute minute = watch(params, 60.0);
  EXPECT_NEAR(minute.turn_rate, M_PI / 2, 0.01);
  EXPECT_NEAR(minute.brake, params.robot.brake_mps2, 0.3);
}

TEST_P(SiteEnvironmentTest, SameSeedSameMotionAnotherSeedAnother) {
  const auto after = [&](int seed) {
    SiteEnvironment place(busy(GetParam(), seed), {});
    for (int i = 0; i < 200; ++i) place.advance(kPeopleStep);
    return std::pair{place.T_world_robot(), place.actors(100.0)};
  };
  const auto [pose, actors] = after(5);
  const auto [same_pose, same_actors] = after(5);
  EXPECT_EQ(pose.matrix(), same_pose.matrix());
  ASSERT_EQ(actors.size(), same_actors.size());
  for (std::size_t i = 0; i < actors.size(); ++i) {
    EXPECT_EQ(actors[i].position, same_actors[i].position);
  }
  EXPECT_NE(pose.matrix(), after(6).first.matrix());
}

TEST_P(SiteEnvironmentTest, VehiclesGoOnPastPeopleWhoSitOrStand) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    SimParams params = busy(GetParam(), seed);
    params.traffic.pedestrians = 0;
    params.traffic.idle_people = 100;
    SiteEnvironment place(params, {});
    std::map<std::int64_t, double> ways;
    for (double t = 0.0; t < 60.0; t += kPeopleStep) {
      place.advance(kPeopleStep);
      for (const Actor& actor : place.actors(100.0)) {
        if (!actor.parked && !isPerson(actor.kind)) ways[actor.id] += actor.speed * kPeopleStep;
      }
    }
    for (const auto& [id, way] : ways) EXPECT_GT(way, 25.0) << "seed " << seed << ", id " << id;
  }
}

TEST_P(SiteEnvironmentTest, TrueVelocitiesAreThoseOfTheMotion) {
  SiteEnvironment place(busy(GetParam(), 1), {});
  std::map<std::int64_t, Eigen::Vector3d> before;
  for (double t = 0.0; t < 20.0; t += kPeopleStep) {
    place.advance(kPeopleStep);
    for (const Actor& actor : place.actors(100.0)) {
      const auto last = before.find(actor.id);
      if (last != before.end()) {
        const Eigen::Vector2d moved = (actor.position - last->second).head<2>() / kPeopleStep;
        EXPECT_LT((moved - actor.velocity).norm(), 0.08 * moved.norm() + 1e-6) << actor.id;
      }
      before[actor.id] = actor.position;
    }
  }
}

TEST_P(SiteEnvironmentTest, AStandingRobotNeverMoves) {
  SimParams params = busy(GetParam(), 1);
  params.robot.standing = true;
  SiteEnvironment place(params, {});
  const Pose first = place.T_world_robot();
  for (int i = 0; i < 200; ++i) place.advance(kPeopleStep);
  EXPECT_EQ(place.T_world_robot().matrix(), first.matrix());
}

TEST_P(SiteEnvironmentTest, HasNoPeopleIfNoneAreConfigured) {
  SimParams params = busy(GetParam(), 1);
  params.traffic.pedestrians = params.traffic.idle_people = 0;
  params.traffic.vehicles = params.traffic.cyclists = 0;
  SiteEnvironment place(params, {});
  for (const Actor& actor : place.actors(100.0)) EXPECT_TRUE(actor.parked);
}

TEST_P(SiteEnvironmentTest, HasADropBesideWhichTheRobotStays) {
  SiteEnvironment place(busy(GetParam(), 2), {});
  ASSERT_FALSE(place.drops().empty());
  for (const Drop& drop : place.drops()) {
    EXPECT_GT(drop.depth_m, 0.5);
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const auto& corner : drop.outline) middle += corner / 4.0;
    EXPECT_EQ(place.grid().clearance(middle), 0.0);
  }
}

TEST_P(SiteEnvironmentTest, WithSomeSeedsTheRobotStartsBesideADrop) {
  int beside = 0;
  for (int seed = 1; seed <= test::repeats(8, 1); ++seed) {
    SiteEnvironment place(busy(GetParam(), seed), {});
    const Eigen::Vector2d robot = place.T_world_robot().translation().head<2>();
    for (const Drop& drop : place.drops()) {
      Eigen::Vector2d middle = Eigen::Vector2d::Zero();
      for (const auto& corner : drop.outline) middle += corner / 4.0;
      beside += (middle - robot).norm() < 4.5 ? 1 : 0;
    }
  }
  EXPECT_GE(beside, test::repeats(2, 0));
  EXPECT_LE(beside, 7);
}

TEST_P(SiteEnvironmentTest, ManyLayoutsLetTheRobotMove) {
  for (int seed = 20; seed < 20 + test::repeats(12, 2); ++seed) {
    SimParams params = busy(GetParam(), seed);
    params.traffic.pedestrians = params.traffic.idle_people = 0;
    params.traffic.vehicles = params.traffic.cyclists = 0;
    const Minute minute = watch(params, 25.0);
    EXPECT_GT(minute.path, 5.0) << "seed " << seed;
    EXPECT_GT(minute.robot_clearance, 0.2) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(All, SiteEnvironmentTest,
                         ::testing::ValuesIn(kKinds.begin(), kKinds.begin() + test::repeats(3, 1)));

TEST(HallTest, SomebodyWalksPastTheRobotAtLessThanSeventyCentimetres) {
  int close = 0;
  for (const int seed : {1, 2, 3}) {
    const Minute minute = watch(busy(Kind::kHall, seed), 60.0);
    if (minute.nearest_person <= 0.7) ++close;
  }
  EXPECT_GE(close, 2);
}

TEST(SiteImuTest, StartsTurnsAndBrakesAreFeltAsTheyAre) {
  SimParams params = busy(Kind::kHall, 3);
  params.traffic.pedestrians = params.traffic.idle_people = 0;
  params.robot.sudden_stop_rate_hz = 0.3;
  params.camera.ride_deg = 0.0;
  SiteEnvironment place(params, {});
  MotionSensors sensors(1);
  constexpr double kImuStep = 0.01;
  std::map<int, Pose> poses;
  for (int i = 0; i < 2000; ++i) {
    sensors.observe(kImuStep * i, place.T_world_robot());
    poses[i] = place.T_world_robot();
    place.advance(kImuStep);
  }
  double worst_turn = 0.0, hardest = 0.0, start = 0.0;
  for (const ImuSample& sample : sensors.takeImu()) {
    const int i = static_cast<int>(std::lround(sample.time / kImuStep));
    const Eigen::Vector3d turn =
        logSo3(poses.at(i - 1).linear().transpose() * poses.at(i + 1).linear()) / (2 * kImuStep);
    worst_turn = std::max(worst_turn, (sample.angular_velocity - turn).norm());
    hardest = std::min(hardest, sample.acceleration.x());
    start = std::max(start, sample.acceleration.x());
  }
  EXPECT_LT(worst_turn, 0.03);  // noise and bias alone
  EXPECT_NEAR(hardest, -params.robot.brake_mps2, 0.6);
  EXPECT_NEAR(start, params.robot.acceleration_mps2, 0.6);
}

/// Whether the robot's middle lies in the footprint of a vehicle.
bool isInsideAVehicle(SiteEnvironment& place) {
  const Eigen::Vector2d robot = place.T_world_robot().translation().head<2>();
  for (const Actor& actor : place.actors(20.0)) {
    if (actor.parked || actor.kind == ActorKind::kPedestrian) continue;
    const Eigen::Vector2d offset =
        Eigen::Rotation2Dd(-actor.yaw) * (robot - actor.position.head<2>());
    if (std::abs(offset.x()) < 0.5 * actor.size.x() && std::abs(offset.y()) < 0.5 * actor.size.y())
      return true;
  }
  return false;
}

TEST(SiteEnvironmentTest, NoVehicleDrivesThroughTheRobot) {
  for (const Kind kind : {Kind::kWarehouse, Kind::kCampus}) {
    for (const int seed : {3, 12, 14}) {
      SiteEnvironment place(busy(kind, seed), {});
      int frames_inside = isInsideAVehicle(place) ? 1 : 0;
      for (int k = 0; k < 150; ++k) {
        place.advance(kPeopleStep);
        frames_inside += isInsideAVehicle(place) ? 1 : 0;
      }
      EXPECT_EQ(frames_inside, 0) << "world " << static_cast<int>(kind) << ", seed " << seed;
    }
  }
}

}  // namespace
}  // namespace headway::sim
