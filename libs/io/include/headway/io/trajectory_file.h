#pragma once

#include <headway/core/pose.h>

#include <string>
#include <vector>

namespace headway::io {

/// Reads `t x y z qx qy qz qw` rows; '#' starts a comment.
///
/// @throws InputError naming file and line of what cannot be read
[[nodiscard]] std::vector<Stamped<Pose>> readTum(const std::string& path);

/// Writes `t x y z qx qy qz qw` rows, seconds with 9 and the rest with 9 decimals.
void writeTum(const std::string& path, const std::vector<Stamped<Pose>>& trajectory);

/// Reads 3x4 row-major poses, one a row (KITTI odometry).
///
/// @throws InputError naming file and line of what cannot be read
[[nodiscard]] std::vector<Pose> readKittiPoses(const std::string& path);

/// Writes 3x4 row-major poses, one a row (KITTI odometry).
void writeKittiPoses(const std::string& path, const std::vector<Pose>& poses);

}  // namespace headway::io
