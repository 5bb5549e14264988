// SPDX-License-Identifier: BSD-3-Clause
// Pose graph optimisation: keyframes that agree best with measured relative poses.
#pragma once

#include <headway/core/ids.h>
#include <headway/core/pose.h>
#include <headway/core/worker_thread.h>

#include <map>
#include <vector>

namespace headway::slam {

/// What is known of one keyframe's pose in another.
struct PoseGraphEdge {
  KeyframeId a;
  KeyframeId b;
  Pose T_a_b = Pose::Identity();
  double sigma_m = 0.1;     ///< of the translation, each axis [m]
  double sigma_rad = 0.01;  ///< of the rotation, each axis [rad]
};

/// Residual of an edge: (translation / sigma_m, rotation vector / sigma_rad), and its derivatives
/// by the right perturbations of both poses where asked for.
[[nodiscard]] Eigen::Matrix<double, 6, 1> edgeResidual(const PoseGraphEdge& edge,
                                                       const Pose& T_map_a, const Pose& T_map_b,
                                                       Eigen::Matrix<double, 6, 6>* by_a,
                                                       Eigen::Matrix<double, 6, 6>* by_b);

/// The poses that agree best with all edges; the first pose stays where it is.
///
/// @param poses  T_map_keyframe, initial values; every edge joins two of them
/// @param stop   ends the solver after its present iteration, with the solution so far
/// @see Grisetti et al. 2010, "A tutorial on graph-based SLAM"
[[nodiscard]] std::map<KeyframeId, Pose> optimisePoseGraph(const std::map<KeyframeId, Pose>& poses,
                                                           const std::vector<PoseGraphEdge>& edges,
                                                           const StopCondition& stop = neverStop);

}  // namespace headway::slam
