// SPDX-License-Identifier: BSD-3-Clause
// Robust poses by consensus: the rigid motions in an image, and which of them is the camera's.
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

/// A rigid motion of part of the scene: the camera's, if that part is static.
struct RigidMotion {
  Pose T_map_cam = Pose::Identity();
  std::vector<bool> agrees;  ///< per constraint
  int members = 0;           ///< how many agree
};

/// The motions that the constraints fall into, in the order they were found.
///
/// The initial poses are tried first; then consensus finds the largest group that none of the
/// motions found so far explains, until what is left agrees on nothing. A landmark may agree with
/// several motions, as far ones do.
///
/// @param initial_poses    poses to begin from
/// @param min_members  landmarks that make a group
/// @see   Fischler & Bolles 1981 (RANSAC); Torr 1998, "Geometric motion segmentation and model
///        selection" (one model after the other)
[[nodiscard]] std::vector<RigidMotion> rigidMotions(
    const std::vector<stereo::PoseConstraint>& constraints, const StereoCamera& camera,
    const std::vector<Pose>& initial_poses, int min_members);

/// How much scene agrees with one motion and not with another, over the image and in depth.
///
/// Every layer of depths (each half as deep again as the one before) counts by the square root of
/// the image cells covered in it. The static scene is deep and surrounds the camera, while a moving
/// object is compact, so its extent is smaller even where it covers most of the image. Landmarks
/// that agree with both motions, as far ones do, do not count.
[[nodiscard]] double extentBeyond(const RigidMotion& motion, const RigidMotion& other,
                                  const std::vector<stereo::PoseConstraint>& constraints,
                                  const StereoCamera& camera);

/// The motion that is the camera's: the one with more extent beyond each of the others.
///
/// @param is_static  per constraint: verified static before; motions that explain these get more
/// weight
/// @return           one of the motions; null if there is none
[[nodiscard]] const RigidMotion* cameraMotion(
    const std::vector<RigidMotion>& motions, const std::vector<stereo::PoseConstraint>& constraints,
    const std::vector<bool>& is_static, const StereoCamera& camera);

/// The camera's motion, if a pose is between two: what stood still, as a parked forklift, may start
/// to move; both motions are then within the gates of a pose that fits neither.
///
/// @param constraints  landmarks that were verified static before
/// @return             the pose given, if half of the constraints fit it well; else that of a motion
///                     that a quarter of them agree on
[[nodiscard]] Pose poseOfOneMotion(const Pose& T_map_cam,
                                   const std::vector<stereo::PoseConstraint>& constraints,
                                   const StereoCamera& camera);

}  // namespace headway::slam
