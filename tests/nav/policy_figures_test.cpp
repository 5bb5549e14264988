// SPDX-License-Identifier: BSD-3-Clause
#include "policy_figures.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace headway::app {
namespace {

TrialResult resultOf(bool reached, double time_s, double distance_m) {
  TrialResult result;
  result.goal_reached = reached;
  result.time_to_goal_s = time_s;
  result.min_distance_m = distance_m;
  result.step_us = {1.0, 5.0, 9.0};
  return result;
}

TEST(PolicyFiguresTest, TimesAreOfTrialsThatAllPoliciesFinish) {
  PolicyTrials one{nav::ObstaclePolicy::kStatic,
                   {resultOf(true, 10.0, 0.2), resultOf(true, 20.0, 0.4)}};
  PolicyTrials other{nav::ObstaclePolicy::kTimeGated,
                     {resultOf(true, 12.0, 1.0), resultOf(false, 60.0, 2.0)}};
  const auto figures = figuresOf({one, other});
  EXPECT_DOUBLE_EQ(figures[0].mean_time_to_goal_s, 10.0);
  EXPECT_DOUBLE_EQ(figures[1].mean_time_to_goal_s, 12.0);
  EXPECT_EQ(figures[1].goals_reached, 1u);
  EXPECT_DOUBLE_EQ(figures[1].mean_min_distance_m, 1.5);
  EXPECT_DOUBLE_EQ(figures[0].step_us_median, 5.0);
}

TEST(PolicyFiguresTest, WalkedIntoIsSeparateFromCollisions) {
  TrialResult hit = resultOf(true, 10.0, 0.0);
  hit.collided = true;
  hit.walked_into = true;
  TrialResult stood = resultOf(true, 10.0, 0.0);
  stood.walked_into = true;
  const auto figures = figuresOf({{nav::ObstaclePolicy::kSweep, {hit, stood}}});
  EXPECT_EQ(figures[0].collisions, 1u);
  EXPECT_EQ(figures[0].walked_into, 1u);
}

TEST(PolicyFiguresTest, JsonHasTheAgreedKeys) {
  const auto json = toJson(figuresOf({{nav::ObstaclePolicy::kTimeGated, {resultOf(true, 9, 1)}}}));
  for (const char* key : {"trials", "collisions", "goals_reached", "mean_time_to_goal_s",
                          "mean_min_distance_m", "step_us_median"}) {
    EXPECT_TRUE(json.at("time_gated").contains(key)) << key;
  }
}

}  // namespace
}  // namespace headway::app
