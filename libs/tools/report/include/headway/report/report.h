// SPDX-License-Identifier: BSD-3-Clause
// The report of a replay as one HTML page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace headway::report {

/// A named figure, such as an error against the truth.
struct Figure {
  std::string name;          ///< "ATE RMSE"
  std::string value;         ///< including the unit: "0.043 m"
  std::string meaning = {};  ///< what it counts, in a few words
};

/// What a report contains besides the results.
struct ReportOptions {
  std::filesystem::path truth;   ///< folder with trajectory.tum and objects.csv; empty: no truth
  std::vector<Figure> errors;    ///< against the truth, computed by the caller
  std::size_t max_pictures = 8;  ///< number of snapshots, evenly spaced over the replay
  std::filesystem::path output;  ///< empty: report.html in the replay's folder
  std::string title;             ///< empty: the name of the replay's folder
};

/// Writes a report of a finished replay as one self-contained HTML page.
///
/// Contains a summary, the trajectory in the map, snapshots, a timeline of tracks, the processing
/// time per stage, the calibration report, dropped input with reasons, and the configuration, read
/// from `summary.json`, `replay.json`, `trajectory.tum`, `tracks.csv`, `map_points.ply` and
/// `snapshots/`. Sections whose files are missing are omitted. The same folder gives the same
/// bytes.
///
///     report::writeReport(outdir);
///
/// @return the page's path
/// @throws InputError if summary.json is missing, a file is malformed, a killed run left results of
///         two runs, or the page cannot be written
std::filesystem::path writeReport(const std::filesystem::path& folder,
                                  const ReportOptions& options = {});

}  // namespace headway::report
