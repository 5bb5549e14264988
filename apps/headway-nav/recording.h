// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "top_view.h"

namespace headway::app {

/// Path of a trial's files without their endings: `FOLDER/trial_NNNN`.
[[nodiscard]] std::string recordingName(const std::string& folder, int seed);

/// Writes `FOLDER/trial_NNNN.mp4` and `FOLDER/trial_NNNN.png` of one trial, all policies side
/// by side. Without an encoder, the video is a folder of numbered pictures.
///
/// @return          the files written
/// @throws InputError if the folder cannot be written
std::vector<std::string> writeRecording(const std::vector<TrialRecord>& records,
                                        const RobotParams& robot, int seed,
                                        const std::string& folder);

}  // namespace headway::app
