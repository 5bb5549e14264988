#pragma once

#include <string>

#include "replay_folder.h"

namespace headway::report {

/// What truly happened, laid on the estimate.
struct TruthLayer {
  std::vector<TimedPlace> trajectory;
  std::vector<TrackLife> objects;
};

/// The world from above as an inline SVG: landmarks, tracks, the robot's path, the true paths, and
/// a scale bar. Empty text where there is no trajectory.
[[nodiscard]] std::string mapPlot(const ReplayFolder& folder, const TruthLayer& truth);

/// Moves the truth so that its place and heading at the replay's first time are the estimate's.
///
/// @throws InputError if the times of the two do not meet
void layOnto(const std::vector<TimedPlace>& estimate, const std::string& truth_name,
             TruthLayer& truth);

}  // namespace headway::report
