// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/sim/crowd.h>

#include <cmath>

namespace headway::sim {
namespace {

constexpr double kStep_s = 0.02;
const RobotCourse kCourse{12.0, 1.0};
const Eigen::Vector2d kFarAway(1000.0, 1000.0);

/// People who walk straight on at their preferred speed.
PeopleParams steadyPeople(Scenario scenario, int count = 4) {
  PeopleParams params;
  params.scenario = scenario;
  params.count = count;
  params.wander_sigma_deg = params.speed_sigma_ratio = 0.0;
  params.timing_sigma_s = params.angle_sigma_deg = 0.0;
  return params;
}

TEST(CrowdTest, TheSameSeedGivesTheSamePeople) {
  const PeopleParams params;
  Crowd one(params, kCourse, 7), same(params, kCourse, 7), other(params, kCourse, 8);
  for (int i = 0; i < 100; ++i) {
    one.walk(kStep_s, {0, 0});
    same.walk(kStep_s, {5, 5});
    other.walk(kStep_s, {0, 0});
  }
  ASSERT_EQ(one.people().size(), same.people().size());
  for (std::size_t i = 0; i < one.people().size(); ++i) {
    EXPECT_EQ(one.people()[i].position, same.people()[i].position) << "wherever the robot is";
    EXPECT_NE(one.people()[i].position, other.people()[i].position);
  }
}

TEST(CrowdTest, CrossingPeopleReachTheRobotsWayWhenTheRobotDoes) {
  Crowd crowd(steadyPeople(Scenario::kCrossing), kCourse, 3);
  std::vector<bool> met(crowd.people().size(), false);
  for (double t = 0.0; t < 15.0; t += kStep_s) {
    for (std::size_t i = 0; i < met.size(); ++i) {
      const Eigen::Vector2d& at = crowd.people()[i].position;
      if (std::abs(at.y()) < 0.05) {
        met[i] = true;
        EXPECT_NEAR(at.x() / kCourse.top_speed_mps + 0.5, t, 0.6);
      }
    }
    crowd.walk(kStep_s, kFarAway);
  }
  for (const bool has_met : met) EXPECT_TRUE(has_met);
}

TEST(CrowdTest, OncomingPeopleWalkTowardsTheRobotAndFollowersAhead) {
  const Crowd oncoming(steadyPeople(Scenario::kOncoming), kCourse, 3);
  for (const auto& person : oncoming.people()) {
    EXPECT_LT(person.velocity().x(), -0.5);
    EXPECT_GE(person.position.x(), kCourse.goal_m - 1e-9);
  }
  const Crowd following(steadyPeople(Scenario::kFollowing), kCourse, 3);
  for (const auto& person : following.people()) {
    EXPECT_GT(person.velocity().x(), 0.0);
    EXPECT_LT(person.velocity().x(), kCourse.top_speed_mps);
    EXPECT_GT(person.position.x(), 1.0);
  }
}

TEST(CrowdTest, GroupsWalkAbreast) {
  const Crowd crowd(steadyPeople(Scenario::kGroups, 3), kCourse, 3);
  EXPECT_GE(crowd.people().size(), 6u);
  EXPECT_LE(crowd.people().size(), 9u);
  const auto& first = crowd.people()[0];
  const auto& second = crowd.people()[1];
  EXPECT_EQ(first.heading, second.heading);
  EXPECT_NEAR((first.position - second.position).norm(), 2.6 * PeopleParams().radius_m, 1e-9);
}

TEST(CrowdTest, WanderingKeepsItsSpread) {
  PeopleParams params = steadyPeople(Scenario::kOncoming, 50);
  params.wander_sigma_deg = 8.0;
  params.speed_sigma_ratio = 0.1;
  Crowd crowd(params, kCourse, 3);
  for (double t = 0.0; t < 10.0; t += kStep_s) crowd.walk(kStep_s, kFarAway);
  double headings = 0.0, speeds = 0.0;
  constexpr int kRounds = 40;
  for (int round = 0; round < kRounds; ++round) {
    for (double t = 0.0; t < 3.0; t += kStep_s) crowd.walk(kStep_s, kFarAway);
    for (const auto& person : crowd.people()) {
      headings += std::pow(person.heading_off, 2) / (50.0 * kRounds);
      speeds += std::pow(person.speed_off, 2) / (50.0 * kRounds);
    }
  }
  EXPECT_NEAR(std::sqrt(headings) * 180.0 / M_PI, 8.0, 0.8);
  EXPECT_NEAR(std::sqrt(speeds), 0.1, 0.01);
}

TEST(CrowdTest, WhoYieldsKeepsAwayFromTheRobotAndOthersDoNot) {
  const auto nearest = [](double yielding) {
    PeopleParams params = steadyPeople(Scenario::kOncoming, 1);
    params.yielding_fraction = yielding;
    Crowd crowd(params, kCourse, 3);
    const Eigen::Vector2d robot(6.0, crowd.people()[0].position.y() + 0.05);
    double distance = 1e9;
    for (double t = 0.0; t < 20.0; t += kStep_s) {
      crowd.walk(kStep_s, robot);
      distance = std::min(distance, (crowd.people()[0].position - robot).norm());
    }
    return distance;
  };
  EXPECT_LT(nearest(0.0), 0.1);
  EXPECT_GT(nearest(1.0), nearest(0.0) + 0.05);
}

TEST(CrowdTest, PillarsStandBesideTheStraightWay) {
  PeopleParams params;
  params.pillars = 20;
  const Crowd crowd(params, kCourse, 3);
  ASSERT_EQ(crowd.pillars().size(), 20u);
  for (const auto& pillar : crowd.pillars()) {
    EXPECT_GE(std::abs(pillar.position.y()), 2.5);
    EXPECT_GT(pillar.position.x(), 0.0);
    EXPECT_LT(pillar.position.x(), kCourse.goal_m);
  }
}

TEST(CrowdTest, MixedTrialsDrawEachScenario) {
  PeopleParams params = steadyPeople(Scenario::kMixed, 3);
  int along = 0, across = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Crowd crowd(params, kCourse, seed);
    const Eigen::Vector2d velocity = crowd.people()[0].velocity();
    (std::abs(velocity.x()) > std::abs(velocity.y()) ? along : across) += 1;
  }
  EXPECT_GT(along, 8);
  EXPECT_GT(across, 8);
}

}  // namespace
}  // namespace headway::sim
