// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "suite_worlds.h"

namespace headway::app {

/// Stores the runs of a world as `NAME.runs` beside its rawlog, for an evaluation elsewhere: poses
/// only; frames and detections are in the rawlog.
///
/// @param parameters  those of the runs, as text
/// @throws InputError if the file cannot be written
void writeRuns(const World& world, const std::string& parameters,
               const std::vector<WorldRun>& runs);

/// The runs as they were stored, bit by bit; `objects` of the last one only.
///
/// @param parameters  those that the runs must have
/// @throws InputError if the file is missing or damaged, or of another version or parameters
[[nodiscard]] std::vector<WorldRun> readRuns(const World& world, const std::string& parameters);

}  // namespace headway::app
