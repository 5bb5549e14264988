// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/eval/pose_pairs.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace headway::eval {
namespace {

void requirePoses(bool empty, const std::string& which) {
  if (empty) throw InputError("the " + which + " is empty");
}

void requireFinite(const Pose& pose, std::size_t row, const std::string& which) {
  if (!pose.matrix().allFinite()) {
    throw InputError("the " + which + " contains a pose that is not finite (row " +
                     std::to_string(row + 1) + ")");
  }
}

std::vector<Stamped<Pose>> sorted(const std::vector<Stamped<Pose>>& trajectory,
                                  const std::string& which) {
  requirePoses(trajectory.empty(), which);
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    requireFinite(trajectory[i].value, i, which);
    if (!std::isfinite(trajectory[i].time)) {
      throw InputError("the " + which + " contains a time that is not finite (row " +
                       std::to_string(i + 1) + ")");
    }
  }
  auto result = trajectory;
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& a, const auto& b) { return a.time < b.time; });
  return result;
}

std::size_t nearest(const std::vector<Stamped<Pose>>& trajectory, Time time) {
  const auto after =
      std::lower_bound(trajectory.begin(), trajectory.end(), time,
                       [](const Stamped<Pose>& pose, Time t) { return pose.time < t; });
  if (after == trajectory.begin()) return 0;
  const auto before = after - 1;
  const bool is_before_nearer =
      after == trajectory.end() || time - before->time <= after->time - time;
  return static_cast<std::size_t>((is_before_nearer ? before : after) - trajectory.begin());
}

std::string spanOf(const std::vector<Stamped<Pose>>& trajectory) {
  return std::to_string(trajectory.front().time) + " .. " + std::to_string(trajectory.back().time) +
         " s";
}

}  // namespace

PosePairs pairByTime(const std::vector<Stamped<Pose>>& truth,
                     const std::vector<Stamped<Pose>>& estimate, double max_difference_s) {
  const auto true_poses = sorted(truth, "true trajectory");
  const auto estimates = sorted(estimate, "estimated trajectory");
  std::map<std::size_t, std::size_t> estimate_of;  // index of the true pose -> of the estimate
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const std::size_t j = nearest(true_poses, estimates[i].time);
    const double difference = std::abs(true_poses[j].time - estimates[i].time);
    if (difference > max_difference_s) continue;
    const auto [previous, inserted] = estimate_of.emplace(j, i);
    if (inserted) continue;
    if (difference < std::abs(true_poses[j].time - estimates[previous->second].time)) {
      previous->second = i;
    }
  }
  if (estimate_of.empty()) {
    throw InputError("no estimated pose has a true pose within " +
                     std::to_string(max_difference_s) + " s: truth spans " + spanOf(true_poses) +
                     ", estimate " + spanOf(estimates));
  }
  PosePairs result{{}, truth.size(), estimate.size()};
  for (const auto& [j, i] : estimate_of) {
    result.pairs.push_back({estimates[i].time, true_poses[j].value, estimates[i].value});
  }
  return result;
}

PosePairs pairByIndex(const std::vector<Pose>& truth, const std::vector<Pose>& estimate) {
  requirePoses(truth.empty(), "true trajectory");
  requirePoses(estimate.empty(), "estimated trajectory");
  PosePairs result{{}, truth.size(), estimate.size()};
  for (std::size_t i = 0; i < std::min(truth.size(), estimate.size()); ++i) {
    requireFinite(truth[i], i, "true trajectory");
    requireFinite(estimate[i], i, "estimated trajectory");
    result.pairs.push_back({static_cast<double>(i), truth[i], estimate[i]});
  }
  return result;
}

}  // namespace headway::eval
