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

/// A pose from landmarks of which many may be wrong, without a guess.
///
/// RANSAC with a fixed seed over three-point solutions, left image alone.
///
/// @param max_error_px  farthest that an agreeing landmark may lie from where it was seen
/// @param most_tries    200 find a third of right ones for sure, 1000 a fifth; fewer are made where
///                      most are right
/// @return nullopt if fewer than `min_inliers` landmarks agree on any pose
/// @see Fischler & Bolles 1981; Lepetit et al. 2009 (EPnP)
[[nodiscard]] std::optional<Consensus> poseByConsensus(
    const std::vector<stereo::PoseConstraint>& constraints, const StereoCamera& camera,
    int min_inliers, double max_error_px, int most_tries = 200);

}  // namespace headway::slam
