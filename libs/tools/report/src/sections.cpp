// SPDX-License-Identifier: BSD-3-Clause
#include "sections.h"

#include <headway/core/object_class.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "html.h"

namespace headway::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kPictureWidth = 1280;
constexpr int kLostImageWidth = 640;

double numberAt(const Json& json, const std::string& key) {
  const auto value = json.find(key);
  return value != json.end() && value->is_number() ? value->get<double>() : std::nan("");
}

std::size_t countOf(double value) {
  constexpr double kMaxCount = 1e15;
  return value > 0.0 ? static_cast<std::size_t>(std::min(value, kMaxCount)) : 0;
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
      {"bad_pose", "pose with values that are not finite"},
      {"behind_camera", "box behind the camera"},
      {"broken_depth", "depth image that cannot be read"},
      {"broken_image", "image that cannot be decoded"},
      {"camera_lost", "frame without a camera pose"},
      {"depth_size", "size of the depth image differs from the calibration"},
      {"dont_care", "marked DontCare"},
      {"duplicate", "second box of the same object"},
      {"image_16_bit", "image with 16 bits per channel"},
      {"image_size", "image size differs from the calibration"},
      {"load_shed", "far box left out because frames took too long"},
      {"low_score", "score below the threshold"},
      {"missing_depth", "file of the depth image not found"},
      {"missing_image", "image file not found"},
      {"nan_box", "box with values that are not finite"},
      {"no_depth", "image without a depth image"},
      {"no_intensity_image", "depth image without an intensity image"},
      {"no_right_image", "stereo observation with a single image"},
      {"no_time", "observation without a time"},
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
         pictureUri(path, kLostImageWidth) +
         "\"><figcaption>The first image in which the camera was lost</figcaption></figure>";
}

/// The first frames of a list of the summary; empty if it has none.
std::string framesText(const ReplayFolder& folder, const char* list) {
  constexpr std::size_t kMaxLength = 160;
  if (!folder.summary.is_object()) return "";
  std::string text;
  for (const auto& frame : folder.summary.value(list, Json::array())) {
    if (text.size() > kMaxLength) return escaped(text + ", …");
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
              grouped(countAt(warning, "count")) +
              " times: " + escaped(warning.value("text", std::string(name))) + "</p>";
    }
  }
  const std::size_t unreliable = countAt(folder.summary, "frames_unreliable");
  if (unreliable > 0) {
    html += "<p class=\"warning\">Camera's pose unreliable in " + grouped(unreliable) +
            " frames: " + framesText(folder, "unreliable_frames") + "</p>";
  }
  const std::size_t apart = countAt(folder.summary, "frames_tracked_in_new_submap");
  if (apart > 0) {
    html +=
        "<p class=\"warning\">Camera tracked in a new submap, whose place in the map was not "
        "known, in " +
        grouped(apart) + " frames: " + framesText(folder, "new_submap_frames") + "</p>";
  }
  const std::size_t lost = countAt(folder.summary, "frames_lost");
  if (lost > 0) {
    html += "<p class=\"warning\">Camera lost in " + grouped(lost) +
            " frames: " + framesText(folder, "lost_frames") + "</p>" + lostImage(folder);
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
  const std::string rectification = textAt(folder.summary, "rectification");
  if (!rectification.empty()) details += "<br>" + escaped(rectification);
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
      grouped(countAt(s, "frames_lost")) + " lost");
  html += tile("Path", fixed(pathLength(folder.trajectory), 1) + "<i> m</i>",
               grouped(countAt(s, "loops")) + " loops closed");
  html += tile("Map", grouped(countAt(s, "landmarks")) + "<i> landmarks</i>",
               grouped(countAt(s, "keyframes")) + " keyframes");
  html += tile("Moving objects", grouped(countAt(s, "tracks_moving")) + "<i> moving</i>",
               grouped(countAt(s, "tracks_confirmed")) + " tracks confirmed");
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
  for (const auto& error : errors) rows += row(error.name, escaped(error.value), "");
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
            pictureUri(path, kPictureWidth) + "\"><figcaption>frame " + escaped(frame) +
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
      row("Matches", grouped(countAt(*report, "matches")), "used for these figures") +
      row("Rectified by headway", report->value("rectified_here", false) ? "yes" : "no",
          "no: the recorded images are rectified");
  return section("calibration", "Calibration", "Measured in the images.", table(rows));
}

std::string droppedSection(const ReplayFolder& folder) {
  const std::string used =
      "<p>" + grouped(countAt(folder.summary, "detections_used")) + " detections were used.</p>";
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
    html += "<details><summary>[" + escaped(name) + "] " + grouped(values.size()) +
            " parameters</summary>" + table(rows) + "</details>";
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

}  // namespace headway::report
