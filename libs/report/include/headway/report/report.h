#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace headway::report {

/// A figure with its name, such as an error against the truth.
struct Figure {
  std::string name;   ///< "ATE RMSE"
  std::string value;  ///< with its unit: "0.043 m"
};

struct ReportOptions {
  std::filesystem::path truth;    ///< folder with trajectory.tum and objects.csv; empty: no truth
  std::vector<Figure> errors;     ///< against the truth, worked out elsewhere
  std::size_t most_pictures = 8;  ///< of the snapshots, spread over the replay
  std::filesystem::path output;   ///< empty: report.html in the folder
};

/// Shows the folder of a finished replay as `report.html`: one page that needs nothing else.
///
/// Summary, the trajectory over the map, snapshots, a timeline of tracks, timings by stage, the
/// calibration report, what was dropped and why, and the configuration, from what the folder holds
/// (`summary.json`, `replay.json`, `trajectory.tum`, `tracks.csv`, `map_points.ply`,
/// `snapshots/`); what is not there is left out. Same folder, same bytes.
///
///     report::writeReport(outdir);
///
/// @return the page's path
/// @throws InputError if summary.json is missing, a file is broken, or the page cannot be written
std::filesystem::path writeReport(const std::filesystem::path& folder,
                                  const ReportOptions& options = {});

}  // namespace headway::report
