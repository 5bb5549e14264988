// SPDX-License-Identifier: BSD-3-Clause
#include "gnss_log.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace headway::replay {
namespace {

constexpr double kMaxFrameGap = 1.0;  // [s]

/// The pose at a time between two frames.
Pose poseBetween(const slam::FrameEstimate& before, const slam::FrameEstimate& after, Time time) {
  const double ratio = (time - before.time) / (after.time - before.time);
  Pose pose = Pose::Identity();
  pose.linear() = quaternionOf(before.T_map_robot)
                      .slerp(ratio, quaternionOf(after.T_map_robot))
                      .toRotationMatrix();
  pose.translation() =
      (1.0 - ratio) * before.T_map_robot.translation() + ratio * after.T_map_robot.translation();
  return pose;
}

bool isEarlier(const GnssFix& fix, Time time) { return fix.time < time; }

}  // namespace

void GnssLog::add(const std::vector<GnssFix>& fixes) {
  for (const auto& fix : fixes) {
    if (added_++ % step_ != 0) continue;
    fixes_.push_back(fix);
    if (fixes_.size() <= max_fixes_) continue;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < fixes_.size(); i += 2) fixes_[kept++] = fixes_[i];
    fixes_.resize(kept);
    step_ *= 2;
  }
}

std::vector<geo::FixOnMap> fixesOnMap(const std::vector<GnssFix>& fixes,
                                      const slam::TrajectoryVisit& visit) {
  std::vector<GnssFix> sorted = fixes;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const GnssFix& a, const GnssFix& b) { return a.time < b.time; });
  std::vector<geo::FixOnMap> result;
  std::optional<slam::FrameEstimate> before;
  visit([&](const slam::FrameEstimate& after) {
    const auto last = std::exchange(before, after.tracked ? std::optional(after) : std::nullopt);
    if (!last || !before || !(after.time > last->time) || after.time - last->time > kMaxFrameGap) {
      return;
    }
    auto fix = std::lower_bound(sorted.begin(), sorted.end(), last->time, isEarlier);
    for (; fix != sorted.end() && fix->time < after.time; ++fix) {
      result.push_back({*fix, poseBetween(*last, after, fix->time) * fix->antenna});
    }
  });
  return result;
}

}  // namespace headway::replay
