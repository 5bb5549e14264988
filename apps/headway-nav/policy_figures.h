// SPDX-License-Identifier: BSD-3-Clause
// Figures of the trials of each policy.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "trial.h"

namespace headway::app {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ContactCounts, by_robot, by_others, with_things, near_misses,
                                   min_distance_m)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DriveResult, contacts, course_m, goal_error_m, lost_s)

/// The trials of one policy, in order of their seeds.
struct PolicyTrials {
  nav::ObstaclePolicy policy = nav::ObstaclePolicy::kStatic;
  std::vector<TrialResult> trials;
};

/// Figures of all trials of one policy.
struct PolicyFigures {
  std::string policy;
  std::size_t trials = 0;
  std::size_t collisions = 0;  ///< trials in which a person and the moving robot overlapped
  std::vector<std::uint64_t> collision_seeds;  ///< of those trials
  std::size_t walked_into = 0;  ///< other trials in which a person walked into the robot at rest
  std::size_t pillars_touched = 0;  ///< trials
  std::size_t goals_reached = 0;
  std::vector<std::uint64_t> unfinished_seeds;  ///< of the other trials
  std::size_t unsafe_steps = 0;
  double mean_time_to_goal_s = 0.0;  ///< of the trials that all policies finish
  double mean_min_distance_m = 0.0;
  double step_us_median = 0.0;
  double sense_us_median = 0.0;
  std::vector<TrialResult> drives;  ///< the trials, if they are in a simulated world
};

/// Name of a policy in command lines.
[[nodiscard]] std::string nameOf(nav::ObstaclePolicy policy);

/// One row a policy.
[[nodiscard]] std::vector<PolicyFigures> figuresOf(const std::vector<PolicyTrials>& policies);

/// Policy -> figures, under the keys that scripts rely on.
[[nodiscard]] nlohmann::ordered_json toJson(const std::vector<PolicyFigures>& figures);

/// Prints a table.
void print(std::ostream& out, const std::vector<PolicyFigures>& figures);

}  // namespace headway::app
