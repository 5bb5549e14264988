// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <Eigen/Core>
#include <map>

#include "sparse_map.h"

namespace headway::slam {

/// Replaces what a map assumes about the right camera's rotation against its calibration.
///
/// Disparities become those of right images that are turned back by the new rotation, the
/// disparities' offset that was a part of the old one becomes 0, and landmarks lie where their
/// reference keyframes measure them, in their old directions. Poses stay, and are to be adjusted.
///
/// @param angles  pitch, yaw, roll: rotation vector along the right camera's axes [rad]
void turnRightCamera(const Eigen::Vector3d& angles, const StereoCamera& camera, SparseMap& map);

/// How an adjustment changed the scale around each keyframe: the way to the next one, or else from
/// the one before, against that way before.
///
/// @param before  poses of the same keyframes before the adjustment
[[nodiscard]] std::map<KeyframeId, double> scaleChanges(const std::map<KeyframeId, Pose>& before,
                                                        const SparseMap& map);

}  // namespace headway::slam
