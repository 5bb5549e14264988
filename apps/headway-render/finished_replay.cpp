// SPDX-License-Identifier: BSD-3-Clause
// A finished replay, read from its folder or from its map alone.
#include "finished_replay.h"

#include <headway/core/error.h>
#include <headway/io/calibration_file.h>
#include <headway/map/map_file.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace headway::render_program {
namespace {

namespace fs = std::filesystem;

constexpr double kSameTimeS = 1e-3;

FinishedReplay replayOf(map::StoredMap stored) {
  FinishedReplay replay;
  replay.map = std::move(stored.map);
  if (stored.camera) replay.camera = std::make_shared<StereoCamera>(*stored.camera);
  return replay;
}

/// A track at an earlier time: where its smoothed path has it, or else where its velocity does; its
/// predictions are of the same places.
///
/// @param moment  of the track [s]
Track movedBack(Track track, Time moment, Time time) {
  const auto& path = track.recent_path;
  const auto after = std::lower_bound(
      path.begin(), path.end(), time - kSameTimeS,
      [](const TrajectoryPoint& point, Time wanted) { return point.time < wanted; });
  if (after != path.end() && std::abs(after->time - time) <= kSameTimeS) {
    track.position = after->position;
    track.yaw = after->yaw;
  } else {
    track.position -= (moment - time) * track.velocity;
  }
  track.recent_path.erase(track.recent_path.begin() + (after - path.begin()),
                          track.recent_path.end());
  for (auto& prediction : track.predictions) {
    for (auto& point : prediction.points) point.horizon_s += moment - time;
  }
  return track;
}

/// The tracks of a map as they were at a time before the map's; later ones are left out.
std::vector<Track> tracksAt(Time time, const CMovingObjectsMap& objects) {
  std::vector<Track> tracks;
  for (const auto& track : objects.tracks()) {
    if (track.first_seen > time + kSameTimeS) continue;
    tracks.push_back(movedBack(track, objects.time(), time));
  }
  return tracks;
}

/// Reads a map file without its replay: its keyframes, and its objects at the last one.
FinishedReplay readMapAlone(const std::string& path) {
  FinishedReplay replay = replayOf(map::loadMap(path));
  for (const auto& keyframe : replay.map.staticMap()->keyframes) {
    replay.frames.push_back({keyframe.frame, keyframe.time, keyframe.T_map_robot, {}, {}});
  }
  if (replay.frames.empty()) replay.frames.emplace_back();
  const auto& objects = replay.map.movingObjects();
  ReplayFrame& last = replay.frames.back();
  if (last.time > 0.0) {
    last.tracks = tracksAt(last.time, objects);
  } else {
    last.tracks = objects.tracks();  // without a keyframe
  }
  return replay;
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
  replay.frames = report::readReplayFrames(input, {}, note);
  replay.input = report::readReplayInput(folder);
  return replay;
}

}  // namespace headway::render_program
