// SPDX-License-Identifier: BSD-3-Clause
// Figures of the trials of each policy.
#include "policy_figures.h"

#include <headway/core/statistics.h>

#include <algorithm>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <ostream>

namespace headway::app {
namespace {

/// The trials that all policies finish.
std::vector<bool> finishedByAll(const std::vector<PolicyTrials>& policies) {
  std::vector<bool> finished;
  for (const auto& policy : policies) {
    finished.resize(std::max(finished.size(), policy.trials.size()), true);
    for (std::size_t i = 0; i < policy.trials.size(); ++i) {
      if (!policy.trials[i].goal_reached) finished[i] = false;
    }
  }
  return finished;
}

ContactCounts sumOf(const std::vector<TrialResult>& drives) {
  ContactCounts sum;
  for (const TrialResult& trial : drives) {
    const ContactCounts& contacts = trial.drive->contacts;
    sum.by_robot += contacts.by_robot;
    sum.by_others += contacts.by_others;
    sum.with_things += contacts.with_things;
    sum.near_misses += contacts.near_misses;
  }
  return sum;
}

nlohmann::ordered_json toJson(const TrialResult& trial) {
  const DriveResult& drive = *trial.drive;
  return {{"seed", trial.seed},
          {"course_m", drive.course_m},
          {"goal_reached", trial.goal_reached},
          {"time_s", trial.time_to_goal_s},
          {"goal_error_m", drive.goal_error_m},
          {"collisions_by_robot", drive.contacts.by_robot},
          {"collisions_by_others", drive.contacts.by_others},
          {"collisions_with_things", drive.contacts.with_things},
          {"near_misses", drive.contacts.near_misses},
          {"min_distance_m", trial.min_distance_m},
          {"lost_s", drive.lost_s},
          {"unsafe_steps", trial.unsafe_steps}};
}

PolicyFigures figuresOf(const PolicyTrials& policy, const std::vector<bool>& finished) {
  PolicyFigures figures;
  figures.policy = nameOf(policy.policy);
  figures.trials = policy.trials.size();
  std::size_t timed = 0;
  std::vector<double> steps, senses;
  for (std::size_t i = 0; i < policy.trials.size(); ++i) {
    const TrialResult& trial = policy.trials[i];
    if (trial.drive) figures.drives.push_back(trial);
    if (trial.collided) {
      ++figures.collisions;
      figures.collision_seeds.push_back(trial.seed);
    }
    if (trial.walked_into && !trial.collided) ++figures.walked_into;
    if (trial.pillar_touched) ++figures.pillars_touched;
    if (trial.goal_reached) {
      ++figures.goals_reached;
    } else {
      figures.unfinished_seeds.push_back(trial.seed);
    }
    figures.unsafe_steps += trial.unsafe_steps;
    figures.mean_min_distance_m += trial.min_distance_m / static_cast<double>(figures.trials);
    steps.insert(steps.end(), trial.step_us.begin(), trial.step_us.end());
    senses.insert(senses.end(), trial.sense_us.begin(), trial.sense_us.end());
    if (!finished[i]) continue;
    figures.mean_time_to_goal_s += trial.time_to_goal_s;
    ++timed;
  }
  if (timed > 0) figures.mean_time_to_goal_s /= static_cast<double>(timed);
  figures.step_us_median = median(std::move(steps));
  figures.sense_us_median = median(std::move(senses));
  return figures;
}

}  // namespace

std::string nameOf(nav::ObstaclePolicy policy) {
  for (const auto& [name, value] : nav::obstaclePolicies()) {
    if (value == policy) return name;
  }
  return "unknown";
}

std::vector<PolicyFigures> figuresOf(const std::vector<PolicyTrials>& policies) {
  const auto finished = finishedByAll(policies);
  std::vector<PolicyFigures> figures;
  for (const auto& policy : policies) figures.push_back(figuresOf(policy, finished));
  return figures;
}

nlohmann::ordered_json toJson(const std::vector<PolicyFigures>& figures) {
  nlohmann::ordered_json json;
  for (const auto& row : figures) {
    json[row.policy] = {{"trials", row.trials},
                        {"collisions", row.collisions},
                        {"collision_seeds", row.collision_seeds},
                        {"walked_into", row.walked_into},
                        {"pillars_touched", row.pillars_touched},
                        {"goals_reached", row.goals_reached},
                        {"unfinished_seeds", row.unfinished_seeds},
                        {"unsafe_steps", row.unsafe_steps},
                        {"mean_time_to_goal_s", row.mean_time_to_goal_s},
                        {"mean_min_distance_m", row.mean_min_distance_m},
                        {"step_us_median", row.step_us_median},
                        {"sense_us_median", row.sense_us_median}};
    if (row.drives.empty()) continue;
    const ContactCounts sum = sumOf(row.drives);
    json[row.policy]["collisions_by_robot"] = sum.by_robot;
    json[row.policy]["collisions_by_others"] = sum.by_others;
    json[row.policy]["collisions_with_things"] = sum.with_things;
    json[row.policy]["near_misses"] = sum.near_misses;
    for (const TrialResult& trial : row.drives) {
      json[row.policy]["drives"].push_back(toJson(trial));
    }
  }
  return json;
}

void print(std::ostream& out, const std::vector<PolicyFigures>& figures) {
  out << "| policy     | trials | collisions | walked into | goals | time to goal | min distance |"
         " step   | of it sensing |\n"
         "| ---------- | -----: | ---------: | ----------: | ----: | -----------: | -----------: |"
         " -----: | ------------: |\n";
  for (const auto& row : figures) {
    out << "| " << std::left << std::setw(10) << row.policy << std::right << " | " << std::setw(6)
        << row.trials << " | " << std::setw(10) << row.collisions << " | " << std::setw(11)
        << row.walked_into << " | " << std::setw(5) << row.goals_reached << " | " << std::fixed
        << std::setprecision(2) << std::setw(10) << row.mean_time_to_goal_s << " s | "
        << std::setw(10) << row.mean_min_distance_m << " m | " << std::setprecision(0)
        << std::setw(3) << row.step_us_median << " us | " << std::setw(10) << row.sense_us_median
        << " us |\n";
  }
  for (const auto& row : figures) {
    if (row.drives.empty()) continue;
    const ContactCounts sum = sumOf(row.drives);
    double lost_s = 0.0;
    for (const TrialResult& trial : row.drives) lost_s += trial.drive->lost_s;
    out << row.policy << ": the robot moved into people " << sum.by_robot << " times, they into it "
        << sum.by_others << "; it touched things " << sum.with_things << " times; "
        << sum.near_misses << " near misses; lost for " << std::setprecision(1) << lost_s << " s\n";
  }
}

}  // namespace headway::app
