#pragma once

#include <headway/core/pose.h>

#include <ostream>
#include <string>
#include <vector>

namespace headway::io {

/// Reads `t x y z qx qy qz qw` rows; '#' starts a comment.
///
/// @throws InputError naming file and line of what cannot be read
[[nodiscard]] std::vector<Stamped<Pose>> readTum(const std::string& path);

/// Writes one row `t x y z qx qy qz qw`, all with 9 decimals, qw not negative.
void writeTumRow(std::ostream& out, const Stamped<Pose>& pose);

/// Writes a row for each pose.
void writeTum(const std::string& path, const std::vector<Stamped<Pose>>& trajectory);

/// Reads 3x4 row-major poses, one a row (KITTI odometry).
///
/// @throws InputError naming file and line of what cannot be read
[[nodiscard]] std::vector<Pose> readKittiPoses(const std::string& path);

/// Writes 3x4 row-major poses, one a row (KITTI odometry).
void writeKittiPoses(const std::string& path, const std::vector<Pose>& poses);

}  // namespace headway::io
