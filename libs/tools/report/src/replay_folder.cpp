// SPDX-License-Identifier: BSD-3-Clause
// The output folder of a replay as the report reads it.
#include "replay_folder.h"

#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>

namespace headway::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxLandmarks = 6000;
// Of the trajectory, and of all tracks' states, above which they are thinned out.
constexpr std::size_t kMaxPoses = 50000;

struct PlyHeader {
  std::size_t count = 0;
  std::size_t stride = 0;                 ///< size of a vertex [bytes]
  std::optional<std::size_t> colours_at;  ///< offset of red, green, blue in it [bytes]
};

std::size_t sizeInBytes(const std::string& type) {
  static const std::map<std::string, std::size_t> kSizes = {
      {"char", 1}, {"uchar", 1}, {"short", 2}, {"ushort", 2},
      {"int", 4},  {"uint", 4},  {"float", 4}, {"double", 8}};
  const auto size = kSizes.find(type);
  return size == kSizes.end() ? 0 : size->second;
}

PlyHeader readHeader(std::istream& file, const std::string& name) {
  PlyHeader header;
  std::string text;
  for (std::string line; std::getline(file, line) && line != "end_header"; text += line + "\n") {
    std::istringstream words(line);
    std::string word, type, name_of_it;
    words >> word >> type;
    if (word == "element" && type == "vertex") words >> header.count;
    if (word != "property") continue;
    words >> name_of_it;
    if (name_of_it == "red") header.colours_at = header.stride;
    header.stride += sizeInBytes(type);
  }
  const bool known =
      text.rfind("ply\nformat binary_little_endian 1.0\n", 0) == 0 &&
      text.find("property float x\nproperty float y\nproperty float z") != std::string::npos;
  if (!file || !known) throw InputError(name + ": is not a binary PLY file with x, y, z");
  const bool has_colours = text.find(
                               "property uchar red\nproperty uchar green\nproperty uchar "
                               "blue") != std::string::npos;
  if (!has_colours) header.colours_at.reset();
  return header;
}

std::vector<fs::path> picturesIn(const fs::path& folder) {
  std::vector<fs::path> pictures;
  if (!fs::is_directory(folder)) return pictures;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".png") pictures.push_back(entry.path());
  }
  std::sort(pictures.begin(), pictures.end());
  return pictures;
}

}  // namespace

nlohmann::ordered_json readJson(const fs::path& path) {
  constexpr int kMaxDepth = 32;  // copies and prints of deeper values would exceed the stack
  const auto limit = [&](int depth, auto, const auto&) {
    if (depth > kMaxDepth) throw InputError(path.string() + ": is nested too deeply");
    return true;
  };
  std::ifstream file(path);
  auto json = nlohmann::ordered_json::parse(file, limit, false);
  if (!json.is_object()) throw InputError(path.string() + ": is not a JSON object");
  return json;
}

std::optional<GridFile> readGrid(const fs::path& path) {
  std::ifstream file(path);
  if (!file) return std::nullopt;
  GridFile grid;
  bool has_origin = false;
  for (std::string line; std::getline(file, line);) {
    const auto value = line.substr(std::min(line.size(), line.find(':') + 1));
    if (line.rfind("image:", 0) == 0) {
      const auto name = value.substr(std::min(value.size(), value.find_first_not_of(' ')));
      grid.picture = path.parent_path() / fs::path(name).filename();
    } else if (line.rfind("resolution:", 0) == 0) {
      grid.resolution_m = std::atof(value.c_str());
    } else if (line.rfind("origin:", 0) == 0) {
      double yaw = 0.0;
      int end = 0;  // only if all of it was read
      std::sscanf(value.c_str(), " [%lf ,%lf ,%lf ]%n", &grid.origin.x(), &grid.origin.y(), &yaw,
                  &end);
      has_origin = end > 0;
    }
  }
  if (!(grid.resolution_m > 0.0) || !fs::is_regular_file(grid.picture)) {
    throw InputError(path.string() + ": names no picture or no resolution");
  }
  if (!has_origin) throw InputError(path.string() + ": its origin is not [x, y, yaw]");
  return grid;
}

ThinnedPath readPath(const fs::path& path, std::size_t max_poses) {
  ThinnedPath thinned;
  auto& poses = thinned.poses;
  std::size_t row = 0;
  io::visitTum(path, [&](const Stamped<Pose>& pose) {
    if (row++ % thinned.step != 0) return;
    poses.push_back(pose);
    if (poses.size() <= max_poses) return;
    thinned.step *= 2;
    for (std::size_t i = 0; 2 * i < poses.size(); ++i) poses[i] = poses[2 * i];
    poses.resize((poses.size() + 1) / 2);
  });
  return thinned;
}

ThinnedTracks readTracks(const fs::path& path, const std::set<double>& times) {
  const auto visit = [&](const auto& use) {
    io::visitTrackCsv(path, [&](const TrackSample& sample) {
      if (times.empty() || times.count(sample.time) > 0) use(sample);
    });
  };
  std::size_t states = 0;
  visit([&](const TrackSample&) { ++states; });
  ThinnedTracks thinned;
  thinned.step = 1 + states / (kMaxPoses + 1);
  std::map<TrackId, TrackHistory> histories;
  std::map<double, std::size_t> frames;
  visit([&](const TrackSample& sample) {
    if (frames.try_emplace(sample.time, frames.size()).first->second % thinned.step != 0) return;
    TrackHistory& history = histories[sample.track.id];
    history.id = sample.track.id.value;
    history.object_class = sample.track.object_class;
    history.points.push_back({sample.time, sample.track.position.x(), sample.track.position.y(),
                              sample.track.status != TrackStatus::kCoasting,
                              isMoving(sample.track)});
  });
  auto& result = thinned.tracks;
  for (auto& [id, history] : histories) {
    std::stable_sort(history.points.begin(), history.points.end(),
                     [](const auto& a, const auto& b) { return a.time < b.time; });
    result.push_back(std::move(history));
  }
  std::stable_sort(result.begin(), result.end(), [](const TrackHistory& a, const TrackHistory& b) {
    return a.points.front().time < b.points.front().time;
  });
  return thinned;
}

std::size_t countPoints(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return readHeader(file, path.string()).count;
}

std::vector<ColouredPoint> readPoints(const std::filesystem::path& path, std::size_t max_points) {
  std::ifstream file(path, std::ios::binary);
  const PlyHeader header = readHeader(file, path.string());
  std::size_t step = 1;
  if (max_points > 0 && header.count > max_points) step = (header.count - 1) / max_points + 1;
  std::vector<ColouredPoint> points;
  std::vector<char> vertex(header.stride);
  for (std::size_t i = 0; i < header.count; ++i) {
    file.read(vertex.data(), static_cast<std::streamsize>(vertex.size()));
    if (!file) throw InputError(path.string() + ": ends before its last vertex");
    if (i % step != 0) continue;
    ColouredPoint point;
    std::memcpy(point.position.data(), vertex.data(), 3 * sizeof(float));
    if (header.colours_at) std::memcpy(&point.colour, &vertex[*header.colours_at], 3);
    points.push_back(point);
  }
  return points;
}

void requireOneRun(const fs::path& folder) {
  if (!fs::is_directory(folder / kReplacingFolder)) return;
  throw InputError(folder.string() +
                   ": contains results of two runs, because one was killed while it replaced those "
                   "of the other; move the files of its folder " +
                   kReplacingFolder + "/ into it, or replay again with -w");
}

ReplayFolder readReplayFolder(const fs::path& path) {
  requireOneRun(path);
  if (!fs::exists(path / "summary.json")) {
    throw InputError((path / "summary.json").string() +
                     ": no such file; a report requires the output folder of a finished replay");
  }
  ReplayFolder folder;
  folder.path = path;
  folder.summary = readJson(path / "summary.json");
  if (fs::exists(path / "replay.json")) folder.record = readJson(path / "replay.json");
  std::set<double> times;  // of the tracks' states that are shown; empty: all
  if (fs::exists(path / "trajectory.tum")) {
    ThinnedPath thinned = readPath(path / "trajectory.tum", kMaxPoses);
    folder.trajectory = std::move(thinned.poses);
    if (thinned.step > 1) {
      for (const auto& pose : folder.trajectory) times.insert(pose.time);
    }
  }
  if (fs::exists(path / "tracks.csv")) {
    ThinnedTracks thinned = readTracks(path / "tracks.csv", times);
    folder.tracks = std::move(thinned.tracks);
    folder.track_step = thinned.step;
  }
  if (fs::exists(path / "map_points.ply")) {
    folder.landmarks = readPoints(path / "map_points.ply", kMaxLandmarks);
  }
  folder.grid = readGrid(path / "map_grid.yaml");
  folder.snapshots = picturesIn(path / "snapshots");
  return folder;
}

}  // namespace headway::report
