#include "finished_replay.h"

#include <headway/core/error.h>
#include <headway/io/calibration_file.h>
#include <headway/map/map_file.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace headway::render_program {
namespace {

namespace fs = std::filesystem;

FinishedReplay replayOf(map::StoredMap stored) {
  FinishedReplay replay;
  replay.map = std::move(stored.map);
  if (stored.camera) replay.camera = std::make_shared<StereoCamera>(*stored.camera);
  return replay;
}

/// Reads a map file without its replay: its keyframes and stored objects.
FinishedReplay readMapAlone(const std::string& path) {
  FinishedReplay replay = replayOf(map::loadMap(path));
  for (const auto& keyframe : replay.map.staticMap()->keyframes) {
    replay.frames.push_back({keyframe.frame, keyframe.time, keyframe.T_map_robot, {}});
  }
  if (replay.frames.empty()) replay.frames.emplace_back();
  replay.frames.back().tracks = replay.map.movingObjects().tracks();
  return replay;
}

void readRecord(const fs::path& path, FinishedReplay& replay) {
  std::ifstream file(path);
  const auto record = nlohmann::json::parse(file, nullptr, false);
  if (!record.is_object()) return;
  const auto& input = record.value("input", nlohmann::json::object());
  const auto textOf = [&](const char* key) {
    const auto value = input.find(key);
    return value != input.end() && value->is_string() ? value->get<std::string>() : std::string();
  };
  replay.rawlog = textOf("rawlog");
  replay.sensor_label = textOf("sensor_label");
}

}  // namespace

FinishedReplay readReplay(const std::string& input, const Note& note) {
  if (fs::is_regular_file(input)) return readMapAlone(input);
  const fs::path folder(input);
  if (!fs::is_directory(folder)) throw InputError(input + ": no such folder or map file");
  const fs::path map_file = folder / "map.headway";
  if (!fs::exists(folder / "trajectory.tum") && !fs::exists(map_file)) {
    throw InputError(input +
                     ": contains neither trajectory.tum nor map.headway; is it the "
                     "output folder of a replay?");
  }
  if (!fs::exists(folder / "trajectory.tum")) return readMapAlone(map_file);
  FinishedReplay replay;
  if (fs::exists(map_file)) {
    replay = replayOf(map::loadMap(map_file));
  } else {
    note("no map.headway in " + input + ": drawn without landmarks");
  }
  if (replay.camera == nullptr && fs::exists(folder / "calibration.yaml")) {
    replay.camera =
        std::make_shared<StereoCamera>(io::readCalibration(folder / "calibration.yaml"));
  }
  replay.frames = readFrames(input, note);
  readRecord(folder / "replay.json", replay);
  return replay;
}

}  // namespace headway::render_program
