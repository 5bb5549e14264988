#pragma once

#include <headway/core/pose.h>

#include <vector>

namespace headway::eval {

/// What is true and what was estimated of one moment.
struct PosePair {
  Time time = 0.0;  ///< the estimate's [s]; the row where poses pair by index
  Pose truth = Pose::Identity();
  Pose estimate = Pose::Identity();
};

/// Poses of two trajectories that belong together, in order of time.
struct PosePairs {
  std::vector<PosePair> pairs;
  std::size_t truth_poses = 0;     ///< of the whole true trajectory
  std::size_t estimate_poses = 0;  ///< of the whole estimated trajectory
};

/// Pairs each estimated pose with the true pose nearest in time.
///
/// One to one: of several estimates that share their nearest true pose, the nearest has it. The
/// trajectories need not be sorted.
///
/// @param max_difference_s  greatest distance in time of a pair [s]
/// @throws InputError if a trajectory is empty, a pose is not finite, or nothing pairs (naming
///         both spans of time)
[[nodiscard]] PosePairs pairByTime(const std::vector<Stamped<Pose>>& truth,
                                   const std::vector<Stamped<Pose>>& estimate,
                                   double max_difference_s);

/// Pairs row i with row i (KITTI odometry); rows beyond the shorter file's end have no partner.
///
/// A frame that was lost counts with the pose its row holds (headway repeats the last one).
///
/// @throws InputError if a trajectory is empty or a pose is not finite
[[nodiscard]] PosePairs pairByIndex(const std::vector<Pose>& truth,
                                    const std::vector<Pose>& estimate);

}  // namespace headway::eval
