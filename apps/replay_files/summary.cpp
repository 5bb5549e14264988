// SPDX-License-Identifier: BSD-3-Clause
// replay.json, summary.json and the summary that is printed.
#include "summary.h"

#include <headway/core/output_file.h>
#include <headway/core/text.h>
#include <headway/core/version.h>
#include <headway/detect/network_detector.h>
#include <unistd.h>

#include <cstdio>
#include <ctime>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

namespace headway::replay {
namespace {

using Json = nlohmann::ordered_json;

Json indexJson(const std::optional<std::size_t>& index) {
  return index ? Json(*index) : Json(nullptr);
}

Json pathJson(const std::string& path) {
  return path.empty() ? Json(nullptr)
                      : Json(std::filesystem::absolute(path).lexically_normal().string());
}

Json calibrationJson(const std::optional<io::CalibrationReport>& report) {
  if (!report) return nullptr;
  if (report->is_depth_camera) {
    return {{"depth_camera", true},
            {"focal_px", report->focal_px},
            {"depth_ratio", report->depth_ratio},
            {"rectified_here", report->rectified_here}};
  }
  return {{"baseline_m", report->baseline_m},
          {"focal_px", report->focal_px},
          {"vertical_disparity_px", report->vertical_disparity_px},
          {"median_disparity_px", report->median_disparity_px},
          {"matches", report->matches},
          {"rectified_here", report->rectified_here}};
}

Json rigJson(const std::optional<stereo::RigCapability>& rig) {
  if (!rig) return nullptr;
  return {{"text", stereo::describe(*rig)},
          {rig->depth_reach_m > 0.0 ? "depth_reach_m" : "baseline_m",
           rig->depth_reach_m > 0.0 ? rig->depth_reach_m : rig->baseline_m},
          {"camera_height_m", rig->camera_height_m},
          {"camera_height_known", rig->camera_height_known},
          {"nearest_m", rig->nearest_m},
          {"min_obstacle_height_m", rig->min_obstacle_height_m},
          {"low_obstacle_height_m", rig->low_obstacle_height_m},
          {"obstacles_from_m", rig->obstacles_from_m},
          {"obstacles_to_m", rig->obstacles_to_m},
          {"people_to_m", rig->people_to_m},
          {"vehicles_to_m", rig->vehicles_to_m}};
}

Json warningsJson(const Warnings& warnings) {
  Json json = Json::object();
  for (const auto& [name, warning] : warnings) {
    json[name] = {
        {"count", warning.count}, {"first_frame", warning.first_frame}, {"text", warning.text}};
  }
  return json;
}

Json stagesJson(const StageTimes& stages) {
  Json json = Json::object();
  for (const auto& [stage, times] : stages.summary()) {
    json[stage] = {{"median", times.median_ms}, {"p95", times.p95_ms}};
  }
  return json;
}

Json geoJson(const GeoSummary& geo) {
  Json json = {{"fixes", geo.fixes}, {"text", describe(geo)}};
  if (!geo.reference) return json;
  json["used"] = geo.reference->used;
  json["rejected"] = geo.reference->rejected;
  json["rmse_m"] = geo.reference->rmse_m;
  json["heading_deg"] = geo.reference->headingDeg();
  json["heading_sigma_deg"] = geo.reference->headingSigmaDeg();
  json["origin_sigma_m"] = geo.reference->originSigma();
  return json;
}

double perFrame(double total, std::size_t frames) {
  return frames == 0 ? 0.0 : total / static_cast<double>(frames);
}

/// Names of files need not be UTF-8; what is not is replaced.
std::string textOf(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::string countsText(const std::map<std::string, std::size_t>& counts) {
  std::string text;
  for (const auto& [reason, count] : counts) {
    text += (text.empty() ? "" : ", ") + printable(reason) + " " + std::to_string(count);
  }
  return text;
}

/// How many boxes made the tracks and where they are from.
std::string boxesText(const Summary& summary) {
  const bool is_recorded =
      summary.detector == "recorded" || (summary.detector == "auto" && summary.has_recorded_boxes);
  std::string text = std::to_string(summary.detections_used);
  if (is_recorded) {
    text += summary.detections_used == 1 ? " recorded box" : " recorded boxes";
  } else {
    text += summary.detections_used == 1 ? " detection" : " detections";
    text += " by " + (summary.detector == "auto" ? summary.image_detectors : summary.detector);
  }
  if (!summary.detections_dropped.empty()) {
    text += " (dropped: " + countsText(summary.detections_dropped) + ")";
  }
  if (is_recorded) text += "; --detector stereo_motion finds objects from images alone";
  return text;
}

}  // namespace

double secondsSinceProcessStart() {
  // proc(5): field 22 of stat is the start in clock ticks since boot; the name in field 2 may
  // contain blanks but ends at the last ')'.
  std::ifstream stat("/proc/self/stat");
  std::string line;
  std::getline(stat, line);
  const auto end_of_name = line.rfind(')');
  if (end_of_name == std::string::npos) return 0.0;
  std::size_t position = end_of_name + 2;
  for (int field = 3; field < 22; ++field) position = line.find(' ', position) + 1;
  const double start = std::stod(line.substr(position)) / static_cast<double>(sysconf(_SC_CLK_TCK));
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) - start;
}

double peakMemoryMb() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    if (word == "VmHWM:") {
      double kib = 0.0;
      status >> kib;
      return kib / 1024.0;
    }
    status.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return 0.0;
}

void writeRunRecord(const std::filesystem::path& path, const Options& options, const Params& params,
                    const std::optional<stereo::RigCapability>& rig,
                    const std::string& detector_model) {
  Json json;
  json["version"] = kVersion;
  json["input"] = {{"rawlog", pathJson(options.input)},
                   {"detections", pathJson(options.detections)},
                   {"map", pathJson(options.load_map)},
                   {"sensor_label", options.sensor_label}};
  json["options"] = {{"realtime", options.realtime},
                     {"from_index", indexJson(options.from_index)},
                     {"to_index", indexJson(options.to_index)},
                     {"snapshots", snapshotsOf(options)},
                     {"theme", options.theme.empty() ? "dark" : options.theme}};
  json["rig"] = rigJson(rig);
  if (!detector_model.empty()) {
    json["detector_model"] = {{"file", pathJson(detector_model)},
                              {"sha256", detect::sha256OfFile(detector_model)}};
  }
  json["configuration"] = Json(params.values());
  writeFile(path, textOf(json));
}

void writeSummary(const std::filesystem::path& path, const Summary& summary) {
  Json json;
  json["frames"] = summary.frames;
  json["frames_tracked"] = summary.frames_tracked;
  json["frames_lost"] = summary.lost_frames.count;
  json["lost_frames"] = summary.lost_frames.listed;
  json["frames_unreliable"] = summary.unreliable_frames.count;
  json["unreliable_frames"] = summary.unreliable_frames.listed;
  json["frames_tracked_in_new_submap"] = summary.new_submap_frames.count;
  json["new_submap_frames"] = summary.new_submap_frames.listed;
  json["late_frames"] = summary.late_frames.listed;
  json["frames_dropped_late"] = summary.frames_dropped_late;
  json["keyframes"] = summary.keyframes;
  json["landmarks"] = summary.landmarks;
  json["submaps"] = summary.submaps;
  json["loops"] = summary.loops;
  json["tracks_confirmed"] = summary.tracks_confirmed;
  json["tracks_moving"] = summary.tracks_moving;
  json["start_up_s"] = summary.start_up_s;
  json["total_s"] = summary.total_s;
  json["frame_ms_mean"] = summary.frame_ms.mean();
  json["frame_ms_median"] = summary.frame_ms.percentile(0.5);
  json["frame_ms_p95"] = summary.frame_ms.percentile(0.95);
  json["frame_ms_max"] = summary.frame_ms.max();
  json["cpu_ms_per_frame"] = perFrame(summary.cpu_ms, summary.frame_ms.count());
  json["stages_ms"] = stagesJson(summary.stages);
  json["peak_memory_mb"] = peakMemoryMb();
  json["detections_used"] = summary.detections_used;
  json["detections_dropped"] = Json(summary.detections_dropped);
  json["calibration"] = calibrationJson(summary.calibration);
  json["rig"] = rigJson(summary.rig);
  if (!summary.rectification.empty()) json["rectification"] = summary.rectification;
  json["warnings"] = warningsJson(summary.warnings);
  json["laser"] = Json(summary.laser);
  if (summary.geo) json["georeference"] = geoJson(*summary.geo);
  json["observations_skipped"] = Json(summary.observations_skipped);
  json["ended_early"] = summary.ended_early ? Json(*summary.ended_early) : Json();
  json["version"] = kVersion;
  json["seed"] = summary.seed;
  writeFile(path, textOf(json));
}

void printSummary(const Summary& summary) {
  std::printf(
      "%zu of %zu frames tracked, %zu lost, %zu unreliable, %zu late, %zu keyframes, %zu "
      "landmarks\n",
      summary.frames_tracked, summary.frames, summary.lost_frames.count,
      summary.unreliable_frames.count, summary.late_frames.count, summary.keyframes,
      summary.landmarks);
  if (summary.new_submap_frames.count > 0 || summary.submaps > 1) {
    std::printf(
        "%zu of the tracked frames in a new submap, whose place in the map was not known; %zu "
        "submaps at the end\n",
        summary.new_submap_frames.count, summary.submaps);
  }
  std::printf("%zu %s confirmed, %zu of them moving; %s", summary.tracks_confirmed,
              summary.tracks_confirmed == 1 ? "track" : "tracks", summary.tracks_moving,
              boxesText(summary).c_str());
  std::printf(
      "\n%.1f ms per frame (median), %.1f ms (95 %%); %.1f ms CPU; %.0f MB; first frame "
      "after %.2f s\n",
      summary.frame_ms.percentile(0.5), summary.frame_ms.percentile(0.95),
      perFrame(summary.cpu_ms, summary.frame_ms.count()), peakMemoryMb(), summary.start_up_s);
  if (!summary.rectification.empty()) std::puts(printable(summary.rectification).c_str());
  if (summary.geo && summary.geo->reference) std::puts(describe(*summary.geo).c_str());
  if (!summary.laser.empty()) {
    std::printf("laser: %s\n", countsText(summary.laser).c_str());
  }
  if (!summary.observations_skipped.empty()) {
    std::printf("skipped observations: %s\n", countsText(summary.observations_skipped).c_str());
  }
}

}  // namespace headway::replay
