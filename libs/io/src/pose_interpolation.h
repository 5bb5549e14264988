#pragma once

#include <headway/core/pose.h>

#include <algorithm>
#include <optional>

namespace headway::io {

/// The pose between the two samples around a time, if they are at most `max_gap_s` apart: position
/// along the line between them, rotation along the shortest turn. Nothing is extrapolated.
///
/// @param poses  container of Stamped<Pose> in time order
template <typename Poses>
[[nodiscard]] std::optional<Pose> poseAt(const Poses& poses, Time time, double max_gap_s) {
  const auto after =
      std::lower_bound(poses.begin(), poses.end(), time,
                       [](const Stamped<Pose>& pose, Time t) { return pose.time < t; });
  if (after == poses.end()) return std::nullopt;
  if (after->time == time) return after->value;
  if (after == poses.begin()) return std::nullopt;
  const auto before = after - 1;
  const double gap = after->time - before->time;
  if (gap > max_gap_s) return std::nullopt;
  const double share = (time - before->time) / gap;
  Pose pose = Pose::Identity();
  pose.translation() =
      (1.0 - share) * before->value.translation() + share * after->value.translation();
  pose.linear() = Eigen::Quaterniond(before->value.linear())
                      .slerp(share, Eigen::Quaterniond(after->value.linear()))
                      .toRotationMatrix();
  return pose;
}

}  // namespace headway::io
