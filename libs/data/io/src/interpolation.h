// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

#include <algorithm>
#include <optional>

namespace headway::io {

/// First sample at or after a time in a time-ordered container of Stamped values.
template <typename Samples>
[[nodiscard]] auto firstFrom(const Samples& samples, Time time) {
  return std::lower_bound(samples.begin(), samples.end(), time,
                          [](const auto& sample, Time t) { return sample.time < t; });
}

/// The samples before and after a time, with the interpolation ratio: 0 at `before`, 1 at `after`.
template <typename Value>
struct Neighbours {
  const Value& before;
  const Value& after;
  double ratio = 0.0;
};

/// The neighbours of a time, if they are at most `max_gap_s` apart, without extrapolation. A sample
/// of exactly that time is returned as both.
template <typename Samples>
[[nodiscard]] auto neighboursOf(const Samples& samples, Time time, double max_gap_s) {
  using Value = decltype(samples.begin()->value);
  std::optional<Neighbours<Value>> none;
  const auto after = firstFrom(samples, time);
  if (after == samples.end()) return none;
  if (after->time == time) return std::optional(Neighbours<Value>{after->value, after->value, 0.0});
  if (after == samples.begin()) return none;
  const auto before = after - 1;
  const double gap = after->time - before->time;
  if (gap > max_gap_s) return none;
  return std::optional(Neighbours<Value>{before->value, after->value, (time - before->time) / gap});
}

/// Pose interpolated between two samples at most `max_gap_s` apart: linear position, slerp
/// rotation.
///
/// @param poses  container of Stamped<Pose> in time order
template <typename Poses>
[[nodiscard]] std::optional<Pose> poseAt(const Poses& poses, Time time, double max_gap_s) {
  const auto around = neighboursOf(poses, time, max_gap_s);
  if (!around) return std::nullopt;
  const auto& [before, after, ratio] = *around;
  if (ratio == 0.0) return before;
  Pose pose = Pose::Identity();
  pose.translation() = (1.0 - ratio) * before.translation() + ratio * after.translation();
  pose.linear() = Eigen::Quaterniond(before.linear())
                      .slerp(ratio, Eigen::Quaterniond(after.linear()))
                      .toRotationMatrix();
  return pose;
}

}  // namespace headway::io
