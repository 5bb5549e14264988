// SPDX-License-Identifier: BSD-3-Clause
// The report of a replay as one HTML page.
#include <headway/core/error.h>
#include <headway/core/object_class.h>
#include <headway/core/output_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/report/report.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "html.h"
#include "replay_folder.h"
#include "sections.h"

namespace headway::report {

/// Style sheet of the page: responsive, light or dark as configured in the reader's system.
inline constexpr char kStyle[] = R"css(
:root{color-scheme:light dark;--ground:#f6f7f9;--card:#fff;--text:#1b2230;--dim:#5d6879;--line:#dfe4ea;
--robot:#c98a00;--truth:#1b2230;--dots:#9aa7b8;--accent:#2f7de1;--pale:#bcd6f7;--warn:#fff1d6;--warntext:#7a4b00}
@media(prefers-color-scheme:dark){:root{--ground:#0f131b;--card:#171d28;--text:#e6eaf0;--dim:#93a0b3;--line:#2a3342;
--robot:#ffd147;--truth:#f0f0f0;--dots:#4c5d75;--accent:#5aa2ff;--pale:#2b4a73;--warn:#3a2c10;--warntext:#ffd98a}}
*{box-sizing:border-box}
body{margin:0;background:var(--ground);color:var(--text);font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,sans-serif}
main{max-width:1180px;margin:0 auto;padding:24px 20px 64px}
header p{color:var(--dim);margin:0 0 8px;overflow-wrap:anywhere}
h1{font-size:1.9rem;line-height:1.2;margin:8px 0 4px;overflow-wrap:anywhere}
h2{font-size:1.25rem;margin:0 0 12px}h3{font-size:1rem;margin:18px 0 6px}
section{background:var(--card);border:1px solid var(--line);border-radius:12px;padding:20px;margin:18px 0}
.lead,.note{color:var(--dim);margin:-6px 0 14px}.note{margin:10px 0 0}
header .warning{background:var(--warn);color:var(--warntext);border-radius:8px;padding:10px 14px;margin:12px 0}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(165px,1fr));gap:12px;margin:18px 0}
.tile{background:var(--card);border:1px solid var(--line);border-radius:12px;padding:14px 16px;display:flex;flex-direction:column}
.tile b{font-size:1.55rem;line-height:1.25;font-weight:650}.tile i{font-style:normal;font-weight:400;font-size:.9rem;color:var(--dim)}
.tile span{color:var(--dim);font-size:.85rem}.tile .name{font-size:.8rem}
svg{display:block;width:100%}
.map{height:auto;border-radius:8px;background:var(--ground)}
.grid{image-rendering:pixelated}
.dots{stroke:var(--dots);stroke-width:2.4;stroke-linecap:round;fill:none}
.robot,.truth,.track,.truthtrack{fill:none;stroke-linejoin:round;stroke-linecap:round}
.track{stroke-width:3;stroke-opacity:.85}.truthtrack{stroke:var(--truth);stroke-width:1.4;stroke-opacity:.5;stroke-dasharray:3 5}
.robot{stroke:var(--robot);stroke-width:4.5}.truth{stroke:var(--truth);stroke-width:2;stroke-dasharray:7 7}
.start{fill:var(--ground);stroke:var(--robot);stroke-width:4}
.bar{stroke:var(--text);stroke-width:5}.bartext{fill:var(--text);font-size:26px}
.legend{display:flex;flex-wrap:wrap;gap:4px 18px;margin:12px 0 0;font-size:.9rem}
.swatch{display:inline-block;width:16px;height:6px;border-radius:3px;margin-right:7px;vertical-align:middle}
.robotswatch{background:var(--robot)}.truthswatch{background:var(--truth)}
.pictures{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,480px),1fr));gap:14px}
figure{margin:0}.pictures figure:first-child:nth-last-child(odd){grid-column:1/-1}img{width:100%;height:auto;border-radius:8px;display:block}
figcaption{color:var(--dim);font-size:.85rem;margin:5px 0 0}
.plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,420px),1fr));gap:20px;margin:0 0 20px}
.area svg{height:90px;border-bottom:1px solid var(--line)}.area figcaption{margin:0 0 6px}
.area{display:grid;grid-template-columns:auto 1fr;gap:0 8px}.area figcaption{grid-column:1/-1}.area .ticks{grid-column:2}
.heights{display:flex;flex-direction:column;justify-content:space-between;text-align:right;color:var(--dim);font-size:.8rem;line-height:1;margin:-.4rem 0}
.lines{stroke:var(--line);fill:none;vector-effect:non-scaling-stroke}
.fill{fill:var(--pale);opacity:.55}.curve{fill:none;stroke:var(--accent);stroke-width:2;vector-effect:non-scaling-stroke}
.ticks{display:flex;justify-content:space-between;color:var(--dim);font-size:.8rem}
.row{display:grid;grid-template-columns:118px 1fr;gap:12px;align-items:center}
.row .name{font-size:.8rem;color:var(--dim);text-align:right;white-space:nowrap;overflow:hidden;text-overflow:ellipsis}
.timeline svg{height:12px;background:linear-gradient(var(--line),var(--line)) center/100% 1px no-repeat}
.timeline .row{min-height:18px}
.timings .row{grid-template-columns:118px 1fr 118px;margin:7px 0}.timings .axis{margin:0}.timings .name{font-size:.9rem;color:var(--text)}
.stage{height:18px}.p95{fill:var(--pale)}.median{fill:var(--accent)}
.figures{font-size:.85rem;color:var(--dim);white-space:nowrap;font-variant-numeric:tabular-nums}
.scroll{overflow-x:auto}table{border-collapse:collapse;width:100%;font-size:.93rem}
th,td{text-align:left;padding:6px 14px 6px 0;border-bottom:1px solid var(--line);vertical-align:top;font-weight:400}
td:nth-child(2){white-space:nowrap;font-variant-numeric:tabular-nums;font-weight:600}td:nth-child(3){color:var(--dim);width:60%}
tr:last-child>*{border-bottom:0}
details{border-top:1px solid var(--line);padding:8px 0}summary{cursor:pointer}details td:nth-child(2){white-space:normal;overflow-wrap:anywhere}
footer{color:var(--dim);font-size:.85rem;margin-top:26px}
@media(max-width:560px){main{padding:14px 12px 40px}section{padding:14px}.row{grid-template-columns:84px 1fr;gap:8px}
.timings .row{grid-template-columns:84px 1fr}.timings .figures{grid-column:2;margin-top:-4px}
.row .name{font-size:.72rem}.tiles{grid-template-columns:1fr 1fr;gap:8px}.tile{padding:10px 12px}.tile b{font-size:1.2rem}
td:nth-child(3){width:auto}.bartext{font-size:38px}.robot{stroke-width:7}.track{stroke-width:5}.dots{stroke-width:3.4}.start{stroke-width:7}}
)css";

namespace {

using Json = nlohmann::ordered_json;

double numberAt(const Json& json, const std::string& key) {
  const auto value = json.find(key);
  return value != json.end() && value->is_number() ? value->get<double>() : std::nan("");
}

std::size_t countOf(double value) {
  return value > 0.0 ? static_cast<std::size_t>(std::min(value, 1e15)) : 0;  // not beyond its type
}

std::size_t countAt(const Json& json, const std::string& key) {
  return countOf(numberAt(json, key));
}

double pathLength(const std::vector<Stamped<Pose>>& path) {
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    length += (path[i].value.translation() - path[i - 1].value.translation()).head<2>().norm();
  }
  return length;
}

std::string tile(const std::string& name, const std::string& value, const std::string& detail) {
  return "<div class=\"tile\"><span class=\"name\">" + name + "</span><b>" + value + "</b><span>" +
         detail + "</span></div>";
}

std::string row(const std::string& name, const std::string& value, const std::string& meaning) {
  return "<tr><th>" + escaped(name) + "</th><td>" + value + "</td><td>" + escaped(meaning) +
         "</td></tr>";
}

std::string table(const std::string& rows) {
  return "<div class=\"scroll\"><table>" + rows + "</table></div>";
}

/// Explanation of a reason for dropping a detection or skipping an observation.
std::string meaningOf(const std::string& reason) {
  static const std::map<std::string, std::string> kMeanings = {
      {"bad_calibration", "observation whose calibration is not usable"},
      {"bad_covariance", "detection whose uncertainty is not usable"},
      {"bad_detections_pose", "boxes whose sensor pose is not finite"},
      {"bad_imu", "inertial measurement with values that are not finite"},
      {"bad_odometry", "odometry with values that are not finite"},
      {"bad_pose", "pose with values that are not finite"},
      {"behind_camera", "box behind the camera"},
      {"broken_depth", "depth image that cannot be read"},
      {"broken_image", "image that cannot be decoded"},
      {"camera_lost", "frame without a camera pose"},
      {"camera_motion_unsure", "frame whose camera motion is too uncertain to find motion in it"},
      {"depth_size", "size of the depth image differs from the calibration"},
      {"dont_care", "marked DontCare"},
      {"duplicate", "second box of the same object"},
      {"image_16_bit", "image with 16 bits per channel"},
      {"image_size", "image size differs from the calibration"},
      {"implausible_object", "region that moves, but not as a person or vehicle could"},
      {"load_shed", "far box left out because frames took too long"},
      {"low_score", "score below the threshold"},
      {"missing_depth", "file of the depth image not found"},
      {"missing_image", "image file not found"},
      {"nan_box", "box with values that are not finite"},
      {"no_depth", "image without a depth image"},
      {"no_intensity_image", "depth image without an intensity image"},
      {"no_right_image", "stereo observation with a single image"},
      {"no_time", "observation without a time"},
      {"part_of_other", "region that belongs to another detection"},
      {"pose_jump", "pose too far from the one before"},
      {"time_backwards", "time not after the previous one"},
      {"too_far", "box beyond the maximum range"},
      {"truth", "truth, used for evaluation only"},
      {"unknown_class", "class unknown to headway"},
      {"unmatched_detections", "boxes that match no frame"},
      {"unmatched_pose", "pose that matches no frame"},
      {"unpaired_image", "image without its stereo counterpart"},
  };
  const auto meaning = kMeanings.find(reason);
  return meaning != kMeanings.end() ? meaning->second : "";
}

std::string countsTable(const Json& counts) {
  std::string rows;
  for (const auto& [reason, count] : counts.items()) {
    if (!count.is_number()) continue;
    rows += row(reason, grouped(countOf(count.get<double>())), meaningOf(reason));
  }
  return rows.empty() ? "<p>None.</p>" : table(rows);
}

/// A text of an object; empty if it has none.
std::string textAt(const Json& object, const char* key) {
  const auto value = object.find(key);
  return value != object.end() && value->is_string() ? value->get<std::string>() : "";
}

std::string recordedText(const ReplayFolder& folder, const char* key) {
  const auto input = folder.record.find("input");
  return input == folder.record.end() || !input->is_object() ? "" : textAt(*input, key);
}

/// The first image in which the camera was lost.
std::string lostImage(const ReplayFolder& folder) {
  const auto path = folder.path / "lost.jpg";
  if (!std::filesystem::exists(path)) return "";
  return "<figure><img alt=\"The first image in which the camera was lost\" src=\"" +
         pictureUri(path, 640) +
         "\"><figcaption>The first image in which the camera was lost</figcaption></figure>";
}

/// The first frames of a list of the summary; empty if it has none.
std::string framesText(const ReplayFolder& folder, const char* list) {
  if (!folder.summary.is_object()) return "";
  std::string text;
  for (const auto& frame : folder.summary.value(list, Json::array())) {
    if (text.size() > 160) return escaped(text + ", …");
    text += (text.empty() ? "" : ", ") + frame.dump();
  }
  return escaped(text);
}

std::string warnings(const ReplayFolder& folder) {
  std::string html;
  const std::string ended = textAt(folder.summary, "ended_early");
  if (!ended.empty()) {
    html += "<p class=\"warning\">The replay ended early: " + escaped(ended) + "</p>";
  }
  const auto found = folder.summary.find("warnings");
  if (found != folder.summary.end() && found->is_object()) {
    for (const auto& [name, warning] : found->items()) {
      html += "<p class=\"warning\">From frame " + grouped(countAt(warning, "first_frame")) + ", " +
              counted(countAt(warning, "count"), "time") + ": " +
              escaped(warning.value("text", std::string(name))) + "</p>";
    }
  }
  const std::size_t unreliable = countAt(folder.summary, "frames_unreliable");
  if (unreliable > 0) {
    html += "<p class=\"warning\">Camera's pose unreliable in " + counted(unreliable, "frame") +
            ": " + framesText(folder, "unreliable_frames") + "</p>";
  }
  const std::size_t apart = countAt(folder.summary, "frames_tracked_in_new_submap");
  if (apart > 0) {
    html +=
        "<p class=\"warning\">Camera tracked in a new submap, whose place in the map was not "
        "known, in " +
        counted(apart, "frame") + ": " + framesText(folder, "new_submap_frames") + "</p>";
  }
  const std::size_t lost = countAt(folder.summary, "frames_lost");
  if (lost > 0) {
    html += "<p class=\"warning\">Camera lost in " + counted(lost, "frame") + ": " +
            framesText(folder, "lost_frames") + "</p>" + lostImage(folder);
  }
  return html;
}

}  // namespace

std::string titleBlock(const ReplayFolder& folder) {
  const std::string rawlog = recordedText(folder, "rawlog");
  const std::string name = rawlog.empty() ? folder.path.filename().string()
                                          : std::filesystem::path(rawlog).filename().string();
  std::string details = escaped(rawlog);
  const std::string detections = recordedText(folder, "detections");
  if (!detections.empty()) details += "<br>detections: " + escaped(detections);
  const auto rig = folder.summary.find("rig");
  if (rig != folder.summary.end() && rig->is_object()) {
    details += "<br>" + escaped(textAt(*rig, "text"));
  }
  const auto georeference = folder.summary.find("georeference");
  if (georeference != folder.summary.end() && georeference->is_object()) {
    details += "<br>" + escaped(textAt(*georeference, "text"));
  }
  return "<header><h1>" + escaped(name) + "</h1><p>" + details + "</p>" + warnings(folder) +
         "</header>\n";
}

std::string summaryTiles(const ReplayFolder& folder) {
  const Json& s = folder.summary;
  std::string html = "<div class=\"tiles\">";
  html += tile(
      "Frames tracked",
      grouped(countAt(s, "frames_tracked")) + "<i> of " + grouped(countAt(s, "frames")) + "</i>",
      grouped(countAt(s, "frames_lost")) + " lost, without a pose of the camera");
  html += tile("Path", fixed(pathLength(folder.trajectory), 1) + "<i> m</i>",
               counted(countAt(s, "loops"), "loop") + " closed at places seen before");
  const std::size_t landmarks = countAt(s, "landmarks");
  html +=
      tile("Map", grouped(landmarks) + (landmarks == 1 ? "<i> landmark</i>" : "<i> landmarks</i>"),
           "points of the map, seen from " + counted(countAt(s, "keyframes"), "keyframe"));
  html += tile("Moving objects", grouped(countAt(s, "tracks_moving")) + "<i> moving</i>",
               "at some time, of " + counted(countAt(s, "tracks_confirmed"), "confirmed track"));
  html += tile("Time per frame", fixed(numberAt(s, "frame_ms_median"), 1) + "<i> ms</i>",
               "95 % below " + fixed(numberAt(s, "frame_ms_p95"), 1) + " ms, maximum " +
                   fixed(numberAt(s, "frame_ms_max"), 1) + " ms");
  html += tile("Processor", fixed(numberAt(s, "cpu_ms_per_frame"), 1) + "<i> ms per frame</i>",
               fixed(numberAt(s, "peak_memory_mb"), 0) + " MB peak, first frame after " +
                   fixed(numberAt(s, "start_up_s"), 2) + " s");
  return html + "</div>\n";
}

std::string errorsSection(const std::vector<Figure>& errors) {
  if (errors.empty()) return "";
  std::string rows;
  for (const auto& error : errors) rows += row(error.name, escaped(error.value), error.meaning);
  return section("errors", "Against the truth", "", table(rows));
}

std::string snapshotsSection(const ReplayFolder& folder, std::size_t max_pictures) {
  const auto& all = folder.snapshots;
  if (all.empty() || max_pictures == 0) return "";
  const std::size_t count = std::min(max_pictures, all.size());
  std::string html = "<div class=\"pictures\">";
  for (std::size_t i = 0; i < count; ++i) {
    const auto& path = all[count == 1 ? all.size() / 2 : i * (all.size() - 1) / (count - 1)];
    const std::string stem = path.stem().string();
    const std::string frame = stem.substr(std::min(stem.find_first_not_of('0'), stem.size() - 1));
    html += "<figure><img loading=\"lazy\" alt=\"The map at frame " + escaped(frame) + "\" src=\"" +
            pictureUri(path, 1280) + "\"><figcaption>frame " + escaped(frame) +
            "</figcaption></figure>";
  }
  return section("snapshots", "Snapshots", "", html + "</div>");
}

std::string depthCameraSection(const Json& report) {
  const double ratio = numberAt(report, "depth_ratio");
  const std::string assessment = ratio > 0.5   ? "good"
                                 : ratio > 0.2 ? "usable: little is within the camera's reach"
                                               : "bad: check the depth images";
  const std::string rows =
      row("Focal length", fixed(numberAt(report, "focal_px"), 2) + " px", "") +
      row("Depth", fixed(100.0 * ratio, 0) + " %", "of the first image: " + assessment) +
      row("Rectified by headway", report.value("rectified_here", false) ? "yes" : "no",
          "no: the recorded images are free of distortion");
  return section("calibration", "Depth camera", "Measured in the images.", table(rows));
}

std::string calibrationSection(const ReplayFolder& folder) {
  const auto report = folder.summary.find("calibration");
  if (report == folder.summary.end() || !report->is_object()) return "";
  if (report->value("depth_camera", false)) return depthCameraSection(*report);
  const double vertical = numberAt(*report, "vertical_disparity_px");
  const std::string assessment = vertical < 0.5   ? "good: left and right rows coincide"
                                 : vertical < 1.5 ? "usable: left and right rows deviate slightly"
                                                  : "bad: check the calibration";
  std::string rows =
      row("Baseline", fixed(numberAt(*report, "baseline_m"), 4) + " m",
          "distance between the cameras") +
      row("Focal length", fixed(numberAt(*report, "focal_px"), 2) + " px", "") +
      row("Vertical disparity", fixed(vertical, 2) + " px", assessment) +
      row("Median disparity", fixed(numberAt(*report, "median_disparity_px"), 1) + " px",
          "of the matches in the first image pair") +
      row("Matches", grouped(countAt(*report, "matches")),
          "points of the first left image found in the right one, used for these figures") +
      row("Rectified by headway", report->value("rectified_here", false) ? "yes" : "no",
          "no: the recorded images are rectified");
  const std::string rectification = textAt(folder.summary, "rectification");
  if (!rectification.empty()) {
    rows += row("Over the run", "", rectification);
  }
  return section("calibration", "Calibration", "Measured in the images.", table(rows));
}

std::string droppedSection(const ReplayFolder& folder) {
  const std::size_t count = countAt(folder.summary, "detections_used");
  const std::string used = "<p>" + counted(count, "detection") + (count == 1 ? " was" : " were") +
                           " used: boxes of the recording or of a detector, which tracks are made "
                           "of. Not used, by reason:</p>";
  return section("dropped", "Dropped input", "",
                 used + "<h3>Detections</h3>" +
                     countsTable(folder.summary.value("detections_dropped", Json::object())) +
                     "<h3>Observations</h3>" +
                     countsTable(folder.summary.value("observations_skipped", Json::object())));
}

std::string configurationSection(const ReplayFolder& folder) {
  const auto configuration = folder.record.find("configuration");
  if (configuration == folder.record.end() || !configuration->is_object()) return "";
  std::string html;
  for (const auto& [name, values] : configuration->items()) {
    if (!values.is_object()) continue;
    std::string rows;
    for (const auto& [key, value] : values.items()) {
      rows += row(key, escaped(value.is_string() ? value.get<std::string>() : value.dump()), "");
    }
    html += "<details><summary>[" + escaped(name) + "] " + counted(values.size(), "parameter") +
            "</summary>" + table(rows) + "</details>";
  }
  return section("configuration", "Configuration", "", html);
}

std::string classLegend(const ReplayFolder& folder, bool with_truth) {
  std::set<ObjectClass> classes;
  for (const auto& history : folder.tracks) classes.insert(history.object_class);
  std::string html = "<p class=\"legend\"><span><i class=\"swatch robotswatch\"></i>robot</span>";
  if (with_truth) html += "<span><i class=\"swatch truthswatch\"></i>truth</span>";
  for (const auto object_class : classes) {
    html += "<span><i class=\"swatch\" style=\"background:" + hex(colourOf(object_class)) +
            "\"></i>" + escaped(std::string(displayName(object_class))) + "</span>";
  }
  return html + "</p>";
}

namespace {

namespace fs = std::filesystem;

TruthLayer readTruth(const ReplayFolder& folder, const fs::path& truth_folder) {
  TruthLayer truth;
  if (truth_folder.empty()) return truth;
  const fs::path path = truth_folder / "trajectory.tum";
  truth.trajectory = io::readTum(path);
  if (fs::exists(truth_folder / "objects.csv")) {
    truth.objects = readTracks(truth_folder / "objects.csv").tracks;
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
  std::string text = rows.empty()
                         ? ""
                         : "One row for each track. Opaque: detected. Translucent: predicted "
                           "without a detection. Thick: moving.";
  if (folder.track_step > 1) {
    text +=
        " Of " + std::to_string(folder.track_step) + " frames one is shown, here and on the map.";
  }
  return section("tracks", "Tracks over time", text, activityPlots(folder) + rows);
}

std::string timingsSection(const ReplayFolder& folder) {
  const std::string bars = timingBars(folder);
  if (bars.empty()) return "";
  return section(
      "timings", "Processing time per stage",
      "Median (dark) and 95th percentile (pale) over the frames; stages run concurrently.", bars);
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
         escaped(textAt(folder.summary, "version")) + "</footer></main></body></html>\n";
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
