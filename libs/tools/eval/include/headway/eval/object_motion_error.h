// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/eval/moving_object_error.h>

namespace headway::eval {

/// How the tracker's motion between two frames is taken from its rows.
enum class ObjectMotion {
  kPoses,     ///< from the poses of both rows
  kVelocity,  ///< translation from the later row's velocity, rotation from the poses
};

/// Motion error of one true object.
struct ObjectMotionError {
  std::int64_t id = -1;
  ObjectClass object_class = ObjectClass::kUnknown;
  std::size_t frames = 0;  ///< pairs of frames evaluated
  double translation_rmse_m = 0.0, translation_mean_m = 0.0;
  double rotation_rmse_deg = 0.0, rotation_mean_deg = 0.0;
};

/// Motion errors of all objects: means over the objects of their RMSE and of their means.
struct ObjectMotionErrors {
  std::vector<ObjectMotionError> objects;  ///< by id
  std::size_t frames = 0;
  std::optional<double> translation_rmse_m, translation_mean_m;
  std::optional<double> rotation_rmse_deg, rotation_mean_deg;
};

/// Error of the motions of matched objects from frame to frame.
///
/// For true poses L of the object in the world, and the estimated motion H that maps the object at
/// frame k-1 to that at frame k in the world, the error is E = L(k)^-1 H L(k-1): its translation
/// and its angle, in the object's true frame. The tracker's map is aligned to the world by the
/// camera pose at frame k-1, so that only the camera's error between both frames contributes. A
/// motion is evaluated if the object is matched at frame k, and its track has rows at both frames.
///
/// @see Morris et al., "DynoSAM: open-source smoothing and mapping framework for dynamic SLAM",
///      arXiv 2501.11893; its evaluation program reports the RMSE of each object
[[nodiscard]] ObjectMotionErrors objectMotionErrors(const MovingObjectInput& input,
                                                    const std::vector<MovingMatch>& matches,
                                                    ObjectMotion motion);

}  // namespace headway::eval
