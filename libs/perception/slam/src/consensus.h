// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/stereo/pose_refiner.h>

#include <optional>
#include <vector>

namespace headway::slam {

/// A pose that a group of landmarks agrees on.
struct Consensus {
  Pose T_map_cam = Pose::Identity();
  int inliers = 0;
};

/// A pose from landmarks of which many may be wrong, without an initial pose.
///
/// RANSAC with a fixed seed over three-point solutions, left image alone.
///
/// @param max_error_px  farthest that an agreeing landmark may lie from where it was seen
/// @param max_tries    200 suffice for an inlier ratio of 1/3, 1000 for 1/5; fewer are made at high
///                      inlier ratios
/// @return nullopt if fewer than `min_inliers` landmarks agree on any pose
/// @see Fischler & Bolles 1981; Lepetit et al. 2009 (EPnP)
[[nodiscard]] std::optional<Consensus> poseByConsensus(
    const std::vector<stereo::PoseConstraint>& constraints, const StereoCamera& camera,
    int min_inliers, double max_error_px, int max_tries = 200);

}  // namespace headway::slam
