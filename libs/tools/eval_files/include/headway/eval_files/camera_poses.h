// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

#include <string>
#include <vector>

namespace headway::eval_files {

enum class PoseFormat { kTum, kKitti };

/// Format of a trajectory file, by the number of columns in its first row.
///
/// @throws InputError naming the file if it is neither format or contains no poses
[[nodiscard]] PoseFormat poseFormatOf(const std::string& path);

/// Frame interval of files without times: KITTI's 10 Hz [s].
inline constexpr double kNominalFrameInterval_s = 0.1;

/// Camera pose in the map at each frame, from a file with one row per frame.
///
/// KITTI poses (camera in the first camera) have no times and are taken as 0.1 s apart. TUM poses
/// are those of the robot in the map.
///
/// @throws InputError naming the file if it cannot be read
[[nodiscard]] std::vector<Stamped<Pose>> readCameraPoses(const std::string& path,
                                                         const Pose& T_robot_cam);

}  // namespace headway::eval_files
