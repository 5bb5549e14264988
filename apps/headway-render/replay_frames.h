#pragma once

#include "finished_replay.h"

namespace headway::render_program {

/// The frames of a replay's folder: final poses, and tracks moved from the online to the final
/// map, each with its past 4 s and its predictions.
///
/// @throws InputError if a file is broken or `trajectory.tum` is missing or empty
[[nodiscard]] std::vector<ReplayFrame> readFrames(const std::string& folder, const Note& note);

}  // namespace headway::render_program
