#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/stereo/pose_refiner.h>

#include <vector>

namespace headway::slam {

/// A motion that part of the scene shares: the camera's, if that part is what stands still.
struct RigidMotion {
  Pose T_map_cam = Pose::Identity();
  std::vector<bool> agrees;  ///< per constraint
  int members = 0;           ///< how many agree
};

/// The motions that the constraints fall into, in the order they were found.
///
/// The likeliest poses are tried first; then consensus finds the largest group that none of the
/// motions found so far explains, until what is left agrees on nothing. A landmark may agree with
/// several motions, as far ones do.
///
/// @param likeliest    poses to begin from
/// @param min_members  landmarks that make a group
/// @see   Fischler & Bolles 1981 (RANSAC); Torr 1998, "Geometric motion segmentation and model
///        selection" (one model after the other)
[[nodiscard]] std::vector<RigidMotion> rigidMotions(
    const std::vector<stereo::PoseConstraint>& constraints, const StereoCamera& camera,
    const std::vector<Pose>& likeliest, int min_members);

/// How much scene agrees with one motion and not with another, over the image and in depth.
///
/// Every layer of depths (each half as deep again as the one before) counts by the square root of
/// the image cells covered in it. The still world is deep and all around; a thing that moves is
/// compact, so it counts for less even where it fills most of the view. What agrees with both, as
/// far landmarks do, says nothing.
[[nodiscard]] double extentBeyond(const RigidMotion& motion, const RigidMotion& other,
                                  const std::vector<stereo::PoseConstraint>& constraints,
                                  const StereoCamera& camera);

/// The motion that is the camera's: the one with more extent beyond each of the others.
///
/// @param proved  per constraint: has proved still before, so that what moves with it counts more
/// @return        one of the motions; null if there is none
[[nodiscard]] const RigidMotion* cameraMotion(
    const std::vector<RigidMotion>& motions, const std::vector<stereo::PoseConstraint>& constraints,
    const std::vector<bool>& proved, const StereoCamera& camera);

}  // namespace headway::slam
