// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/report/report.h>

#include "html.h"
#include "replay_folder.h"
#include "sections.h"
#include "style.h"

namespace headway::report {
namespace {

namespace fs = std::filesystem;

TruthLayer readTruth(const ReplayFolder& folder, const fs::path& truth_folder) {
  TruthLayer truth;
  if (truth_folder.empty()) return truth;
  const fs::path path = truth_folder / "trajectory.tum";
  truth.trajectory = io::readTum(path);
  if (fs::exists(truth_folder / "objects.csv")) {
    truth.objects = readTracks(truth_folder / "objects.csv");
  }
  alignToEstimate(folder.trajectory, path.string(), truth);
  return truth;
}

std::string mapSection(const ReplayFolder& folder, const TruthLayer& truth) {
  const std::string plot = mapPlot(folder, truth);
  if (plot.empty()) return "";
  return section("map", "Map",
                 "Plan view of the robot's path, the landmarks, free ground (green) and obstacles "
                 "(red), and the paths of moving objects. Dots "
                 "are static objects.",
                 plot + classLegend(folder, !truth.trajectory.empty()));
}

std::string tracksSection(const ReplayFolder& folder) {
  const std::string rows = timeline(folder);
  return section("tracks", "Tracks over time",
                 rows.empty() ? ""
                              : "Opaque: detected. Translucent: predicted without a detection. "
                                "Thick: moving.",
                 activityPlots(folder) + rows);
}

std::string timingsSection(const ReplayFolder& folder) {
  const std::string bars = timingBars(folder);
  if (bars.empty()) return "";
  return section("timings", "Processing time per stage", "Median and 95th percentile.", bars);
}

std::string versionOf(const ReplayFolder& folder) {
  const auto version = folder.summary.find("version");
  return version != folder.summary.end() && version->is_string() ? version->get<std::string>() : "";
}

std::string pageOf(const ReplayFolder& folder, const ReportOptions& options) {
  const TruthLayer truth = readTruth(folder, options.truth);
  const std::string title =
      escaped(options.title.empty() ? folder.path.filename().string() : options.title);
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>" +
         title + " – headway</title><style>" + kStyle + "</style></head><body><main>\n" +
         titleBlock(folder) + summaryTiles(folder) + errorsSection(options.errors) +
         mapSection(folder, truth) + snapshotsSection(folder, options.max_pictures) +
         tracksSection(folder) + timingsSection(folder) + calibrationSection(folder) +
         droppedSection(folder) + configurationSection(folder) + "<footer>headway " +
         escaped(versionOf(folder)) + "</footer></main></body></html>\n";
}

std::string readPage(const fs::path& folder, const ReportOptions& options) {
  const ReplayFolder replay = readReplayFolder(folder);
  try {
    return pageOf(replay, options);
  } catch (const nlohmann::json::exception& error) {
    throw InputError((folder / "summary.json").string() +
                     ": an entry is not what a replay writes: " + error.what());
  }
}

}  // namespace

fs::path writeReport(const fs::path& folder_path, const ReportOptions& options) {
  const fs::path absolute = fs::weakly_canonical(folder_path);
  const std::string page = readPage(absolute, options);
  const fs::path path = options.output.empty() ? folder_path / "report.html" : options.output;
  writeFile(path, page);
  return path;
}

}  // namespace headway::report
