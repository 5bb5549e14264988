// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/eval/moving_object_error.h>

#include <string>
#include <vector>

namespace headway::eval_files {

/// Reads labels, true poses and the output folder of a replay.
///
/// The evaluated frames are those of the replay. True poses are a rawlog's `truth_pose`, or one row
/// per frame: KITTI (camera) or TUM (robot).
///
/// @throws InputError naming the file that cannot be read or does not match the others
[[nodiscard]] eval::MovingObjectInput readMoversInput(const std::string& labels,
                                                      const std::string& poses,
                                                      const std::string& replay);

/// The input's rows replaced by those of `tracks_smoothed.csv`.
///
/// @throws InputError if the file cannot be read
[[nodiscard]] eval::MovingObjectInput withSmoothedRows(const eval::MovingObjectInput& input,
                                                       const std::string& replay);

}  // namespace headway::eval_files
