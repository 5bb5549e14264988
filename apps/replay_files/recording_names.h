// SPDX-License-Identifier: BSD-3-Clause
// Names of the folders of several recordings.
#pragma once

#include <string>
#include <vector>

namespace headway::replay {

/// Names of the result folders of several recordings: each file's name up to ".rawlog". Equal names
/// get the names of the folders above the files, as far as they differ: of "mon/robot.rawlog" and
/// "tue/robot.rawlog", "mon-robot" and "tue-robot". The order of the files does not matter.
///
/// @param files  different ones
[[nodiscard]] std::vector<std::string> recordingNames(const std::vector<std::string>& files);

}  // namespace headway::replay
