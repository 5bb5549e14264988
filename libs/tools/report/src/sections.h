// SPDX-License-Identifier: BSD-3-Clause
// Parts of the report.
#pragma once

#include <headway/report/report.h>

#include <string>

#include "replay_folder.h"

// Parts of the page as HTML; each is empty if there is nothing to show.

namespace headway::report {

/// Title, input files, and warnings if the replay ended early or lost frames.
[[nodiscard]] std::string titleBlock(const ReplayFolder& folder);
/// Main figures as tiles.
[[nodiscard]] std::string summaryTiles(const ReplayFolder& folder);
/// Errors against the truth.
[[nodiscard]] std::string errorsSection(const std::vector<Figure>& errors);
/// Up to `max_pictures` snapshots, evenly spaced over the replay.
[[nodiscard]] std::string snapshotsSection(const ReplayFolder& folder, std::size_t max_pictures);
[[nodiscard]] std::string calibrationSection(const ReplayFolder& folder);
/// Unused detections and observations, by reason.
[[nodiscard]] std::string droppedSection(const ReplayFolder& folder);
[[nodiscard]] std::string configurationSection(const ReplayFolder& folder);
/// Colours of the object classes in the replay.
[[nodiscard]] std::string classLegend(const ReplayFolder& folder, bool with_truth);

/// True trajectories in the estimated map frame.
struct TruthLayer {
  std::vector<Stamped<Pose>> trajectory;
  std::vector<TrackHistory> objects;
};

/// Moves the truth on the ground plane so that its position and heading at the first common time
/// agree with the estimate.
///
/// @param truth_name  file name for messages
/// @throws InputError if no times of estimate and truth agree within 0.05 s
void alignToEstimate(const std::vector<Stamped<Pose>>& estimate, const std::string& truth_name,
                     TruthLayer& truth);

/// Plan view as an inline SVG: landmarks, tracks, robot path, true paths and a scale bar.
[[nodiscard]] std::string mapPlot(const ReplayFolder& folder, const TruthLayer& truth);

/// Time bars of the 60 longest tracks in order of appearance: opaque while confirmed, translucent
/// while coasting, thick while moving.
[[nodiscard]] std::string timeline(const ReplayFolder& folder);

/// Speed of the robot and number of tracks over time, as two plots.
[[nodiscard]] std::string activityPlots(const ReplayFolder& folder);

/// Median and 95th percentile of the processing time of each stage, as bars.
[[nodiscard]] std::string timingBars(const ReplayFolder& folder);

}  // namespace headway::report
