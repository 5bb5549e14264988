// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

#include <Eigen/Geometry>
#include <string>

namespace headway::slam {

/// Cuts a map of StereoSlam::save() to a box: what remains are the keyframes whose robot was in the
/// box, and of the landmarks that they see those in the box. Ids do not change.
///
/// @param box          in the map frame [m]
/// @param T_robot_cam  pose of the left camera on the robot
/// @throws InputError if the bytes are cut off, damaged or of another version
[[nodiscard]] std::string croppedMap(const std::string& saved, const Eigen::AlignedBox3d& box,
                                     const Pose& T_robot_cam);

}  // namespace headway::slam
