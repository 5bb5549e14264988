#pragma once

#include <map>
#include <string>

#include "finished_replay.h"

namespace headway::render_program {

/// What truly happened, moved onto the estimated map.
struct Truth {
  std::vector<Stamped<Pose>> path;
  std::map<std::size_t, std::vector<Track>> objects;  ///< by frame
};

/// Reads `trajectory.tum` and `objects.csv` of a truth folder; the true pose at the first estimated
/// time is laid on the estimated one. What is missing is noted.
///
/// @throws InputError if there is neither, a file is broken, or the times do not meet
[[nodiscard]] Truth readTruth(const std::string& folder, const std::vector<ReplayFrame>& frames,
                              const Note& note);

}  // namespace headway::render_program
