#include "replay_folder.h"

#include <headway/core/error.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "point_cloud_file.h"

namespace headway::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostLandmarks = 6000;

nlohmann::ordered_json readJson(const fs::path& path) {
  std::ifstream file(path);
  auto json = nlohmann::ordered_json::parse(file, nullptr, false);
  if (!json.is_object()) throw InputError(path.string() + ": is not a JSON object");
  return json;
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

std::vector<TrackLife> readTracks(const fs::path& path) {
  const TextTable table(path);
  std::map<std::int64_t, TrackLife> lives;
  for (std::size_t row = 0; row < table.size(); ++row) {
    const auto id = static_cast<std::int64_t>(table.number(row, "track_id"));
    TrackLife& life = lives[id];
    life.id = id;
    life.object_class = objectClassFrom(table.text(row, "class")).value_or(ObjectClass::kUnknown);
    life.points.push_back({table.number(row, "time"), table.number(row, "x"),
                           table.number(row, "y"), table.text(row, "status") != "coasting",
                           table.number(row, "moving") != 0.0});
  }
  std::vector<TrackLife> result;
  for (auto& [id, life] : lives) {
    std::stable_sort(life.points.begin(), life.points.end(),
                     [](const auto& a, const auto& b) { return a.time < b.time; });
    result.push_back(std::move(life));
  }
  std::stable_sort(result.begin(), result.end(), [](const TrackLife& a, const TrackLife& b) {
    return a.points.front().time < b.points.front().time;
  });
  return result;
}

ReplayFolder readReplayFolder(const fs::path& path) {
  if (!fs::exists(path / "summary.json")) {
    throw InputError((path / "summary.json").string() +
                     ": no such file; a report is made from the folder of a finished replay");
  }
  ReplayFolder folder;
  folder.path = path;
  folder.summary = readJson(path / "summary.json");
  if (fs::exists(path / "replay.json")) folder.record = readJson(path / "replay.json");
  if (fs::exists(path / "trajectory.tum")) folder.trajectory = readPath(path / "trajectory.tum");
  if (fs::exists(path / "tracks.csv")) folder.tracks = readTracks(path / "tracks.csv");
  if (fs::exists(path / "map_points.ply")) {
    folder.landmarks = readPoints(path / "map_points.ply", kMostLandmarks);
  }
  folder.snapshots = picturesIn(path / "snapshots");
  return folder;
}

}  // namespace headway::report
