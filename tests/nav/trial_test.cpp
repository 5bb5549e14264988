// SPDX-License-Identifier: BSD-3-Clause
#include "trial.h"

#include <gtest/gtest.h>
#include <headway_test/input_error.h>
#include <headway_test/repeats.h>

namespace headway::app {
namespace {

TrialSetup setupOf(nav::ObstaclePolicy policy, int people) {
  TrialSetup setup;
  setup.world.people.count = people;
  setup.nav.policy = policy;
  setup.nav.robot.radius_m = setup.world.robot.radius();
  setup.nav.robot.max_speed_mps = setup.world.robot.max_speed_mps;
  return setup;
}

void expectSame(const TrialResult& a, const TrialResult& b) {
  EXPECT_EQ(a.goal_reached, b.goal_reached);
  EXPECT_EQ(a.time_to_goal_s, b.time_to_goal_s);
  EXPECT_EQ(a.min_distance_m, b.min_distance_m);
  EXPECT_EQ(a.collided, b.collided);
  EXPECT_EQ(a.step_us.size(), b.step_us.size());
}

TEST(TrialTest, ReachesItsGoalWithoutPeople) {
  TrialRunner runner(setupOf(nav::ObstaclePolicy::kTimeGated, 0));
  const auto result = runner.run(1);
  EXPECT_TRUE(result.goal_reached);
  EXPECT_FALSE(result.collided);
  EXPECT_EQ(result.unsafe_steps, 0u);
  EXPECT_LT(result.time_to_goal_s, 14.0);
}

TEST(TrialTest, IsTheSameEachTimeAndWhateverRanBefore) {
  const auto setup = setupOf(nav::ObstaclePolicy::kTimeGated, 3);
  TrialRunner runner(setup);
  const auto first = runner.run(7);
  static_cast<void>(runner.run(8));
  expectSame(runner.run(7), first);
  TrialRunner other(setup);
  expectSame(other.run(7), first);
}

TEST(TrialTest, PeopleWalkTheSameWhateverTheRobotDoes) {
  const auto people_at_5s = [](nav::ObstaclePolicy policy) {
    TrialRunner runner(setupOf(policy, 3));
    std::vector<sim::Person> people;
    static_cast<void>(runner.run(3, [&](const TrialMoment& moment) {
      if (moment.time_s < 5.001) people = moment.people;
    }));
    return people;
  };
  const auto one = people_at_5s(nav::ObstaclePolicy::kStatic);
  const auto other = people_at_5s(nav::ObstaclePolicy::kTimeGated);
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].position, other[i].position);
}

TEST(TrialTest, ClearanceIsMeasuredBetweenFootprints) {
  RobotParams robot;
  robot.length_m = 1.0;
  robot.width_m = 0.5;
  const mrpt::math::TPose2D turned(2.0, 0.0, M_PI / 2.0);
  EXPECT_NEAR(clearance(robot, turned, {2.0, 2.0}, 0.25), 1.25, 1e-9);
  EXPECT_NEAR(clearance(robot, turned, {4.0, 0.0}, 0.25), 1.5, 1e-9);
  EXPECT_EQ(clearance(robot, turned, {2.2, 0.0}, 0.25), 0.0);
}

TEST(TrialTest, ForesightCollidesLessThanThePointsOfNow) {
  constexpr std::uint64_t kSeeds = test::repeats(30, 3);
  std::size_t collisions_static = 0, collisions_gated = 0;
  TrialRunner seeing(setupOf(nav::ObstaclePolicy::kTimeGated, 3));
  TrialRunner blind(setupOf(nav::ObstaclePolicy::kStatic, 3));
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    if (blind.run(seed).collided) ++collisions_static;
    if (seeing.run(seed).collided) ++collisions_gated;
  }
  EXPECT_LE(collisions_gated, collisions_static);
  if (test::kSanitized) return;
  EXPECT_GE(collisions_static, 3u);
  EXPECT_LT(collisions_gated, collisions_static);
}

TEST(TrialTest, RefusesParametersOutOfRange) {
  TrialSetup setup = setupOf(nav::ObstaclePolicy::kStatic, 1);
  setup.world.sensors.detection_rate_hz = 0.0;
  EXPECT_EQ("[sensors] detection_rate_hz: '0' is out of range [Hz, 1 .. 50]",
            test::inputErrorOf([&] { TrialRunner runner(setup); }));
}

}  // namespace
}  // namespace headway::app
