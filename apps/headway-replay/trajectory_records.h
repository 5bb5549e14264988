// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/slam/trajectory_record.h>

#include <cstddef>
#include <filesystem>
#include <ostream>

namespace headway::replay {

/// File of a running replay from which --continue restores its trajectory; it is removed at the end
/// of the run.
inline constexpr char kTrajectoryRecords[] = "trajectory_records.txt";

/// Writes a record as a row: frame F T TRACKED KEYFRAME POSE, move FROM TO POSE, or
/// given F T TRACKED POSE, with poses as 3x4 matrices by columns, exactly.
void writeTrajectoryRecord(std::ostream& out, const slam::TrajectoryRecord& record);

/// Reads the first rows of such a file.
///
/// @throws InputError if the file cannot be read; the reader, if it has fewer rows or wrong ones
[[nodiscard]] slam::TrajectoryReader readTrajectoryRecords(const std::filesystem::path& path,
                                                           std::size_t rows);

}  // namespace headway::replay
