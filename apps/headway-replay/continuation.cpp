// SPDX-License-Identifier: BSD-3-Clause
#include "continuation.h"

#include <headway/core/error.h>
#include <headway/io/trajectory_file.h>
#include <headway/program/output_folder.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "results.h"
#include "trajectory_records.h"

namespace headway::replay {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json listJson(const FrameList& list) { return {{"count", list.count}, {"listed", list.listed}}; }

FrameList listFrom(const Json& json) {
  return {json.at("count"), json.at("listed").get<std::vector<std::size_t>>()};
}

Json tracksJson(const std::map<TrackId, ProgramState::SeenTrack>& tracks) {
  Json json = Json::array();
  for (const auto& [id, seen] : tracks) {
    json.push_back({id.value, seen.last_seen, seen.was_moving});
  }
  return json;
}

Json gnssJson(const GnssLog& log) {
  Json fixes = Json::array();
  for (const auto& fix : log.fixes()) {
    fixes.push_back({fix.time, fix.antenna.x(), fix.antenna.y(), fix.antenna.z(), fix.latitude_deg,
                     fix.longitude_deg, fix.altitude_m, fix.sigma_m});
  }
  return {{"added", log.added()}, {"step", log.step()}, {"fixes", fixes}};
}

GnssLog gnssFrom(const Json& json) {
  std::vector<GnssFix> fixes;
  for (const auto& row : json.at("fixes")) {
    const auto v = row.get<std::array<double, 8>>();
    fixes.push_back({v[0], {v[1], v[2], v[3]}, v[4], v[5], v[6], v[7]});
  }
  GnssLog log;
  log.restore(std::move(fixes), json.at("added"), json.at("step"));
  return log;
}

ProgramState unpacked(const std::string& text) {
  const Json json = Json::parse(text);
  ProgramState state;
  Summary& summary = state.summary;
  summary.frames = json.at("frames");
  summary.frames_tracked = json.at("frames_tracked");
  summary.lost_frames = listFrom(json.at("lost_frames"));
  summary.unreliable_frames = listFrom(json.at("unreliable_frames"));
  summary.late_frames = listFrom(json.at("late_frames"));
  summary.frames_dropped_late = json.at("frames_dropped_late");
  summary.loops = json.at("loops");
  summary.tracks_confirmed = json.at("tracks_confirmed");
  summary.tracks_moving = json.at("tracks_moving");
  summary.detections_used = json.at("detections_used");
  summary.detections_dropped = json.at("detections_dropped").get<DropCounts>();
  summary.observations_skipped =
      json.at("observations_skipped").get<std::map<std::string, std::size_t>>();
  summary.continued_after = json.at("continued_after").get<std::vector<std::size_t>>();
  if (!json.at("next_frame").is_null()) state.next_frame = json.at("next_frame");
  for (const auto& seen : json.at("seen_tracks")) {
    state.seen_tracks[TrackId{seen.at(0)}] = {seen.at(1), seen.at(2)};
  }
  if (json.contains("gnss")) state.gnss = gnssFrom(json.at("gnss"));
  state.rows = json.at("rows").get<std::map<std::string, std::size_t>>();
  for (const char* name : {"trajectory_online.tum", kTrajectoryRecords}) {
    if (state.rows.count(name) == 0) throw InputError(std::string("it has no rows of ") + name);
  }
  return state;
}

Json readRecord(const fs::path& path) {
  std::ifstream file(path);
  Json record = Json::parse(file, nullptr, false);
  if (record.is_object()) return record;
  throw InputError(path.string() + ": is missing or damaged, so that the run cannot be continued");
}

std::string textAt(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::optional<std::size_t> indexAt(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number_unsigned()) return std::nullopt;
  return found->get<std::size_t>();
}

void takeRecord(const fs::path& path, Options& options, Params& params) {
  const Json record = readRecord(path);
  try {
    const Json& input = record.at("input");
    options.input = textAt(input, "rawlog");
    options.detections = textAt(input, "detections");
    options.load_map = textAt(input, "map");
    if (options.sensor_label.empty()) options.sensor_label = textAt(input, "sensor_label");
    const Json& run = record.at("options");
    options.realtime = run.at("realtime");
    options.from_index = indexAt(run, "from_index");
    options.to_index = indexAt(run, "to_index");
    options.snapshots = run.at("snapshots").get<std::size_t>();
    options.theme = run.value("theme", "dark");
    for (const auto& [section, keys] : record.at("configuration").items()) {
      for (const auto& [key, value] : keys.items()) {
        std::string assignment = section;
        assignment += "." + key + "=" + value.get<std::string>();
        params.set(assignment);
      }
    }
  } catch (const Json::exception& error) {
    throw InputError(path.string() + ": is no record of a replay: " + error.what());
  } catch (const InputError& error) {
    throw InputError(path.string() + ": is of another version: " + error.what());
  }
}

/// The checkpoint in a folder; null if there is none.
std::shared_ptr<const Continuation> readCheckpoint(const fs::path& folder) {
  const fs::path path = folder / "map.headway";
  if (!fs::exists(path)) return nullptr;
  auto continuation = std::make_shared<Continuation>();
  continuation->folder = folder;
  continuation->map = map::loadMap(path);
  auto& attachments = continuation->map.attachments;
  const auto program = attachments.find(kProgramAttachment);
  const auto run = attachments.find(kRunAttachment);
  if (run == attachments.end() || program == attachments.end()) {
    throw InputError(folder.string() +
                     ": the run has ended; to extend its map, use --load-map in a new folder");
  }
  try {
    continuation->run = std::move(run->second);
    continuation->extent = pipeline::extentOf(continuation->run);
    continuation->state = unpacked(program->second);
  } catch (const std::exception& error) {
    throw InputError(path.string() + ": cannot be continued: " + error.what());
  }
  attachments.erase(run);
  attachments.erase(kProgramAttachment);
  return continuation;
}

}  // namespace

std::string packed(const ProgramState& state) {
  const Summary& summary = state.summary;
  const Json json = {{"frames", summary.frames},
                     {"frames_tracked", summary.frames_tracked},
                     {"lost_frames", listJson(summary.lost_frames)},
                     {"unreliable_frames", listJson(summary.unreliable_frames)},
                     {"late_frames", listJson(summary.late_frames)},
                     {"frames_dropped_late", summary.frames_dropped_late},
                     {"loops", summary.loops},
                     {"tracks_confirmed", summary.tracks_confirmed},
                     {"tracks_moving", summary.tracks_moving},
                     {"detections_used", summary.detections_used},
                     {"detections_dropped", Json(summary.detections_dropped)},
                     {"observations_skipped", Json(summary.observations_skipped)},
                     {"continued_after", Json(summary.continued_after)},
                     {"next_frame", state.next_frame ? Json(*state.next_frame) : Json()},
                     {"seen_tracks", tracksJson(state.seen_tracks)},
                     {"rows", Json(state.rows)},
                     {"gnss", gnssJson(state.gnss)}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void continueRun(const fs::path& folder, Options& options, Params& params) {
  if (!fs::is_directory(folder)) throw InputError(folder.string() + ": no such folder of a run");
  // A run whose publication was killed has ended.
  program::OutputFolder::completePublication(folder, isResult);
  const fs::path unfinished = folder / "unfinished";
  const fs::path run = fs::is_directory(unfinished) ? unfinished : folder;
  options.output = folder.string();
  takeRecord(run / "replay.json", options, params);
  options.continuation = readCheckpoint(run);
  if (options.continuation != nullptr) return;
  options.overwrite = true;
  if (!options.quiet) {
    std::printf("%s: was killed before its first checkpoint, and starts again\n",
                folder.string().c_str());
  }
}

slam::TrajectoryReader trajectoryOf(const Continuation& run) {
  return readTrajectoryRecords(run.folder / kTrajectoryRecords,
                               run.state.rows.at(kTrajectoryRecords));
}

std::vector<Stamped<Pose>> onlinePath(const fs::path& folder, std::size_t rows) {
  auto path = io::readTum(folder / "trajectory_online.tum");
  path.resize(std::min(path.size(), rows));
  return path;
}

}  // namespace headway::replay
