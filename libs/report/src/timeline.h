#pragma once

#include <string>

#include "replay_folder.h"

namespace headway::report {

/// When each track was seen: one row a track, solid where it was confirmed, pale where it was
/// coasting, high where it was moving. The longest 60, in order of first sight.
[[nodiscard]] std::string timeline(const ReplayFolder& folder);

/// Speed of the robot and number of tracks over time, as two small plots.
[[nodiscard]] std::string activityPlots(const ReplayFolder& folder);

/// Median and 95 % of the milliseconds of each stage, as bars.
[[nodiscard]] std::string timingBars(const ReplayFolder& folder);

}  // namespace headway::report
