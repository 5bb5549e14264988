// SPDX-License-Identifier: BSD-3-Clause
// Several recordings of one camera, replayed into one map.
#include "recordings.h"

#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/core/stereo_camera.h>
#include <headway/core/text.h>
#include <headway/core/version.h>
#include <headway/io/rawlog_source.h>
#include <headway/map/map_export.h>
#include <headway/program/progress.h>
#include <headway/scene/snapshot.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "recording_names.h"
#include "result_files.h"

namespace headway::replay {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr char kRecord[] = "recordings.json";

fs::path mapFolder(std::size_t index) {
  return index == 0 ? fs::path() : fs::path("map-" + std::to_string(index + 1));
}

/// Folders that a previous run has written, by its record.
std::set<std::string> foldersOf(const fs::path& output) {
  std::set<std::string> folders;
  std::ifstream file(output / kRecord);
  const Json record = Json::parse(file, nullptr, false);
  if (!record.is_object()) return folders;
  for (const char* list : {"recordings", "maps"}) {
    for (const auto& entry : record.value(list, Json::array())) {
      if (entry.is_object() && entry.contains("folder") && entry["folder"].is_string()) {
        folders.insert(entry["folder"].get<std::string>());
      }
    }
  }
  return folders;
}

program::OutputFolder::IsResult isResultOf(const Options& options,
                                           const std::vector<std::string>& names) {
  auto folders = foldersOf(options.output);
  folders.insert(names.begin(), names.end());
  for (std::size_t i = 1; i < names.size(); ++i) folders.insert(mapFolder(i).string());
  return [folders](const fs::path& file) {
    if (program::isResult(file)) return true;
    const fs::path folder = *file.begin();
    return folders.count(folder.string()) > 0 && program::isResult(file.lexically_relative(folder));
  };
}

/// Difference of two cameras' poses on the robot; empty if there is none.
std::string differenceOfMounts(const StereoCamera& a, const StereoCamera& b) {
  constexpr double kTolerance = 0.002;  // mounts so near are the same [m, rad]
  const Pose difference = a.T_robot_cam.inverse(Eigen::Isometry) * b.T_robot_cam;
  const double metres = difference.translation().norm();
  const double radians = logSo3(difference.linear()).norm();
  if (metres <= kTolerance && radians <= kTolerance) return "";
  char text[80];
  std::snprintf(text, sizeof text, "%.3f m and %.2f deg", metres, radians * 180.0 / M_PI);
  return text;
}

/// Whether a map is of more recordings, or of as many and has more keyframes.
bool isLarger(const pipeline::JointMap& a, const pipeline::JointMap& b) {
  if (a.runs.size() != b.runs.size()) return a.runs.size() > b.runs.size();
  return a.stored.map.staticMap()->keyframes.size() > b.stored.map.staticMap()->keyframes.size();
}

/// The inputs. @throws InputError unless all are recordings of one camera at one place on the robot
const std::vector<std::string>& ofOneCamera(const Options& options) {
  std::shared_ptr<const StereoCamera> first;
  for (const auto& input : options.inputs) {
    io::RawlogSourceOptions source;
    source.sensor_label = options.sensor_label;
    const auto camera = io::RawlogSource(input, source).camera();
    if (camera == nullptr) {
      throw InputError(input +
                       ": contains no stereo images, so that it has no part in a common map");
    }
    if (first == nullptr) first = camera;
    if (const auto difference = differenceBetween(*first, *camera)) {
      throw InputError(input + ": is the recording of another camera than " +
                       options.inputs.front() + " (" + *difference +
                       "); a common map takes recordings of one camera");
    }
    const std::string difference = differenceOfMounts(*first, *camera);
    if (difference.empty()) continue;
    throw InputError(input + ": its camera is mounted " + difference + " away from that of " +
                     options.inputs.front() + "; a common map takes recordings of one rig");
  }
  return options.inputs;
}

}  // namespace

Recordings::Recordings(const Options& options, const pipeline::PerceptionParams& perception_params,
                       const Params& params)
    : options_(options),
      names_(recordingNames(ofOneCamera(options))),
      folder_(options.output, options.overwrite, options.inputs, isResultOf(options, names_)) {
  for (std::size_t i = 0; i < options.inputs.size(); ++i) {
    Options own = options;
    own.input = options.inputs[i];
    own.output = (folder_.path() / names_[i]).string();
    own.published = (folder_.published() / names_[i]).string();
    if (!options.quiet) std::printf("%s\n", printable(names_[i] + ": " + own.input).c_str());
    recordings_.push_back({own.input,
                           names_[i],
                           std::make_unique<Replay>(own, perception_params, params),
                           Pose::Identity(),
                           {}});
  }
}

void Recordings::run() {
  processAll();
  try {
    joinMaps();
  } catch (...) {
    keep(std::current_exception());
  }
  complete();
  if (failure_ && folder_.hasOldResults()) keepOldResults();
  writeRecord();
  folder_.publish();
  if (!options_.quiet) report();
  if (!failure_) failure_ = truncation_;
  if (failure_) std::rethrow_exception(failure_);
}

void Recordings::processAll() {
  for (Recording& recording : recordings_) {
    if (!options_.quiet) std::printf("%s:\n", printable(recording.name).c_str());
    recording.replay->process();  // after an interrupt, of no frame
  }
}

void Recordings::joinMaps() {
  std::vector<pipeline::Perception*> runs;
  for (Recording& recording : recordings_) runs.push_back(&recording.replay->perception());
  auto joined = pipeline::joinMaps(runs);
  std::stable_sort(joined.begin(), joined.end(), isLarger);
  const auto nothing_mapped = [](const pipeline::JointMap& joint) {
    return joint.stored.map.staticMap()->keyframes.empty();
  };
  joined.erase(std::remove_if(joined.begin(), joined.end(), nothing_mapped), joined.end());
  for (const auto& joint : joined) place(joint);
  for (std::size_t i = 0; i < joined.size(); ++i) writeMap(std::move(joined[i]), maps_[i]);
}

/// Enters a map, and moves what its recordings have written into it.
void Recordings::place(const pipeline::JointMap& joint) {
  MapOfRecordings& map = maps_.emplace_back();
  map.folder = mapFolder(maps_.size() - 1);
  map.recordings = joint.runs;
  map.links = joint.links;
  for (std::size_t i = 0; i < joint.runs.size(); ++i) {
    Recording& recording = recordings_[joint.runs[i]];
    recording.map = maps_.size() - 1;
    recording.T_map_run = joint.T_map_run[i];
    if (joint.runs.size() > 1) recording.replay->moveInto(recording.T_map_run);
  }
  if (maps_.size() > 1) warnApart(map);
}

void Recordings::warnApart(const MapOfRecordings& map) const {
  std::cerr << options_.program << ": " << printable(namesOf(map)) << ": shares no place with "
            << printable(namesOf(maps_.front())) << "; the map is in "
            << printable((folder_.published() / map.folder).string()) << std::endl;
}

void Recordings::writeMap(pipeline::JointMap joint, MapOfRecordings& map) {
  const fs::path folder = folder_.path() / map.folder;
  fs::create_directories(folder);
  const auto& view = *joint.stored.map.staticMap();
  map.keyframes = view.keyframes.size();
  map.landmarks = view.landmarks.size();
  joint.stored.configuration = recordings_.front().replay->configuration();
  scene::saveScene((folder / "scene.3Dscene").string(), {joint.stored.map});
  const MapFixes fixes = fixesOf(map);
  if (fixes.recorded > 0) joint.stored.attachments[kGnssAttachment] = gnssBytes(fixes.on_map);
  map::writeMapFiles(folder, std::move(joint.stored));
  if (fixes.recorded > 0) writeGeo(map, fixes);
}

/// Those of all recordings of the map.
Recordings::MapFixes Recordings::fixesOf(const MapOfRecordings& map) const {
  MapFixes fixes;
  for (const std::size_t i : map.recordings) {
    const Replay& replay = *recordings_[i].replay;
    fixes.recorded += replay.gnss().added();
    fixes.kept += replay.gnss().kept();
    const auto& perception = replay.perception();
    const auto own =
        replay.gnss().onMap(perception.trajectorySnapshot(), *perception.map().staticMap());
    fixes.on_map.insert(fixes.on_map.end(), own.begin(), own.end());
  }
  std::stable_sort(fixes.on_map.begin(), fixes.on_map.end(),
                   [](const auto& a, const auto& b) { return a.fix.time < b.fix.time; });
  return fixes;
}

void Recordings::writeGeo(const MapOfRecordings& map, const MapFixes& fixes) const {
  const GeoSummary summary = georeferenced(fixes.on_map, fixes.recorded, fixes.kept);
  if (summary.reference) {
    writeMapGeo(folder_.path() / map.folder / "map_geo.json", summary);
  } else {
    std::cerr << options_.program << ": " << describe(summary) << std::endl;
  }
}

void Recordings::complete() {
  for (Recording& recording : recordings_) {
    try {
      recording.replay->complete();
    } catch (const TruncatedInput&) {
      if (!truncation_) truncation_ = std::current_exception();
    } catch (...) {
      keep(std::current_exception());
    }
  }
}

void Recordings::keepOldResults() const {
  try {
    std::rethrow_exception(failure_);
  } catch (const std::exception& error) {
    throw InputError(error.what() + ("; the old results in " + folder_.published().string()) +
                     " remain, the new ones are in " + folder_.path().string());
  }
}

void Recordings::keep(std::exception_ptr failure) {
  if (!failure_) failure_ = std::move(failure);
}

void Recordings::writeRecord() const {
  Json recordings = Json::array();
  for (const Recording& recording : recordings_) {
    Json pose = Json::array();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        pose.push_back(recording.T_map_run.matrix()(row, column));
      }
    }
    recordings.push_back({{"folder", recording.name},
                          {"rawlog", printable(recording.input)},
                          {"map", recording.map ? Json(*recording.map) : Json()},
                          {"map_from_own_map", pose},
                          {"frames", recording.replay->summary().frames},
                          {"frames_tracked", recording.replay->summary().frames_tracked}});
  }
  Json maps = Json::array();
  for (const MapOfRecordings& map : maps_) {
    Json members = Json::array();
    for (const std::size_t i : map.recordings) members.push_back(recordings_[i].name);
    maps.push_back({{"folder", map.folder.empty() ? "." : map.folder.string()},
                    {"recordings", members},
                    {"keyframes", map.keyframes},
                    {"landmarks", map.landmarks},
                    {"keyframes_recognised", map.links}});
  }
  const Json json = {{"version", kVersion}, {"recordings", recordings}, {"maps", maps}};
  writeFile(folder_.path() / kRecord,
            json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

std::string Recordings::namesOf(const MapOfRecordings& map) const {
  std::string names;
  for (const std::size_t i : map.recordings) {
    names += (names.empty() ? "" : ", ") + recordings_[i].name;
  }
  return names;
}

void Recordings::report() const {
  for (const Recording& recording : recordings_) {
    std::printf("\n%s:\n", printable(recording.name).c_str());
    printSummary(recording.replay->summary());
  }
  std::printf("\n");
  for (const MapOfRecordings& map : maps_) {
    const fs::path folder = folder_.published() / map.folder;
    std::printf(
        "map of %s: %zu keyframes, %zu landmarks, %zu keyframes recognised in the map of "
        "another recording: %s\n",
        printable(namesOf(map)).c_str(), map.keyframes, map.landmarks, map.links,
        printable(folder.string()).c_str());
  }
}

}  // namespace headway::replay
