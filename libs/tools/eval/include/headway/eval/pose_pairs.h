// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

#include <vector>

namespace headway::eval {

/// True and estimated pose at one time.
struct PosePair {
  Time time = 0.0;  ///< of the estimate [s]; the row number if paired by index
  Pose truth = Pose::Identity();
  Pose estimate = Pose::Identity();
};

/// Corresponding poses of two trajectories, in order of time.
struct PosePairs {
  std::vector<PosePair> pairs;
  std::size_t truth_poses = 0;     ///< of the whole true trajectory
  std::size_t estimate_poses = 0;  ///< of the whole estimated trajectory
};

/// Pairs each estimated pose with the true pose nearest in time.
///
/// One to one: of several estimates with the same nearest true pose, only the nearest is paired.
/// The trajectories need not be sorted.
///
/// @param max_difference_s  maximum time difference of a pair [s]
/// @throws InputError if a trajectory is empty, a pose is not finite, or there is no pair; the
///         message then contains both time spans
[[nodiscard]] PosePairs pairByTime(const std::vector<Stamped<Pose>>& truth,
                                   const std::vector<Stamped<Pose>>& estimate,
                                   double max_difference_s);

/// Pairs row i with row i (KITTI odometry); surplus rows of the longer trajectory are ignored.
///
/// Lost frames are evaluated with the pose in their row (headway repeats the last one).
///
/// @throws InputError if a trajectory is empty or a pose is not finite
[[nodiscard]] PosePairs pairByIndex(const std::vector<Pose>& truth,
                                    const std::vector<Pose>& estimate);

}  // namespace headway::eval
