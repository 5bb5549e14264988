#include <headway/core/error.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "finished_replay.h"

namespace headway::render_program {
namespace {

namespace fs = std::filesystem;

constexpr double kSameTimeS = 1e-4;
constexpr double kPastS = 4.0;

/// Frames that were lost, unreliable or late, and so have no row in the trajectory.
std::set<std::size_t> lostFrames(const fs::path& folder) {
  std::ifstream file(folder / "summary.json");
  const auto summary = nlohmann::json::parse(file, nullptr, false);
  std::set<std::size_t> lost;
  if (!summary.is_object()) return lost;
  for (const char* key : {"lost_frames", "unreliable_frames", "late_frames"}) {
    for (const auto& index : summary.value(key, nlohmann::json::array())) {
      if (index.is_number_unsigned()) lost.insert(index.get<std::size_t>());
    }
  }
  return lost;
}

std::size_t firstFrame(const fs::path& folder) {
  std::ifstream file(folder / "replay.json");
  const auto record = nlohmann::json::parse(file, nullptr, false);
  if (!record.is_object()) return 0;
  const auto& options = record.value("options", nlohmann::json::object());
  const auto from = options.find("from_index");
  return from != options.end() && from->is_number_unsigned() ? from->get<std::size_t>() : 0;
}

/// Assigns frame indices to the rows of the trajectory; `known` has the indices and times of the
/// tracks' rows, which resolve skipped frames.
std::vector<ReplayFrame> framesOf(const fs::path& folder, const std::vector<Stamped<Pose>>& poses,
                                  const std::map<Time, std::size_t>& known) {
  const auto lost = lostFrames(folder);
  std::size_t next = firstFrame(folder);
  std::vector<ReplayFrame> frames;
  for (const auto& pose : poses) {
    const auto close = known.lower_bound(pose.time - kSameTimeS);
    if (close != known.end() && close->first <= pose.time + kSameTimeS) next = close->second;
    while (lost.count(next) != 0) ++next;
    frames.push_back({next++, pose.time, pose.value, {}});
  }
  return frames;
}

/// Transformation from the online map to the final map at each frame.
std::vector<Pose> corrections(const std::vector<ReplayFrame>& frames,
                              const std::vector<Stamped<Pose>>& online) {
  std::vector<Pose> result;
  for (const auto& frame : frames) {
    const auto pose = std::lower_bound(
        online.begin(), online.end(), frame.time - kSameTimeS,
        [](const Stamped<Pose>& candidate, Time time) { return candidate.time < time; });
    const bool found = pose != online.end() && pose->time <= frame.time + kSameTimeS;
    result.push_back(found ? Pose(frame.T_map_robot * pose->value.inverse()) : Pose::Identity());
  }
  return result;
}

void transform(const Pose& T_final_online, Track& track) {
  const Eigen::Matrix3d& R = T_final_online.linear();
  track.position = T_final_online * track.position;
  track.velocity = R * track.velocity;
  track.yaw = wrapAngle(track.yaw + yawOf(T_final_online));
  for (auto& path : track.predictions) {
    for (auto& point : path.points) {
      point.position = T_final_online * point.position;
      point.covariance =
          R.topLeftCorner<2, 2>() * point.covariance * R.topLeftCorner<2, 2>().transpose();
    }
  }
}

using PathsByFrame = std::map<std::pair<std::size_t, TrackId>, std::vector<PredictedPath>>;

PathsByFrame readPredictions(const fs::path& path) {
  PathsByFrame paths;
  for (const auto& row : io::readPredictionCsv(path)) {
    auto& modes = paths[{row.frame, row.id}];
    if (modes.empty() || modes.back().mode != row.mode) {
      modes.push_back({row.mode, row.probability, {}});
    }
    modes.back().points.push_back(row.point);
  }
  return paths;
}

using PathsByTrack = std::map<TrackId, std::vector<TrajectoryPoint>>;

/// Past path of each track in the final map, ascending in time.
PathsByTrack pathsOf(const std::vector<TrackSample>& samples,
                     const std::map<std::size_t, std::size_t>& position_of,
                     const std::vector<Pose>& to_final) {
  PathsByTrack places;
  for (const auto& sample : samples) {
    const auto position = position_of.find(sample.frame);
    if (position == position_of.end()) continue;
    const Pose& T_final_online = to_final[position->second];
    places[sample.track.id].push_back({sample.frame, sample.time,
                                       T_final_online * sample.track.position,
                                       wrapAngle(sample.track.yaw + yawOf(T_final_online))});
  }
  for (auto& [id, points] : places) {
    std::stable_sort(points.begin(), points.end(),
                     [](const auto& a, const auto& b) { return a.time < b.time; });
  }
  return places;
}

/// Adds to each track its positions of the last kPastS.
void addPast(const PathsByTrack& places, std::vector<ReplayFrame>& frames) {
  for (auto& frame : frames) {
    for (auto& track : frame.tracks) {
      const auto points = places.find(track.id);
      if (points == places.end()) continue;
      for (const auto& point : points->second) {
        if (point.time >= frame.time - kPastS && point.time < frame.time - kSameTimeS) {
          track.recent_path.push_back(point);
        }
      }
    }
  }
}

/// Positions of frame indices in the list of frames.
std::map<std::size_t, std::size_t> positionsOf(const std::vector<ReplayFrame>& frames) {
  std::map<std::size_t, std::size_t> positions;
  for (std::size_t i = 0; i < frames.size(); ++i) positions[frames[i].frame] = i;
  return positions;
}

/// Adds each track with its predictions to its frame, transformed to the final map; tracks of
/// frames without a pose are ignored.
void addTracks(const std::vector<TrackSample>& samples, const PathsByFrame& paths,
               const std::map<std::size_t, std::size_t>& position_of,
               const std::vector<Pose>& to_final, std::vector<ReplayFrame>& frames) {
  for (const auto& sample : samples) {
    const auto position = position_of.find(sample.frame);
    if (position == position_of.end()) continue;
    Track track = sample.track;
    const auto path = paths.find({sample.frame, track.id});
    if (path != paths.end()) track.predictions = path->second;
    transform(to_final[position->second], track);
    frames[position->second].tracks.push_back(std::move(track));
  }
}

}  // namespace

std::vector<ReplayFrame> readFrames(const std::string& folder_name, const Note& note) {
  const fs::path folder(folder_name);
  const auto poses = io::readTum(folder / "trajectory.tum");
  if (poses.empty()) throw InputError((folder / "trajectory.tum").string() + ": contains no pose");
  std::vector<TrackSample> samples;
  if (fs::exists(folder / "tracks.csv")) {
    samples = io::readTrackCsv(folder / "tracks.csv");
  } else {
    note("no tracks.csv in " + folder_name + ": drawn without tracks");
  }
  std::map<Time, std::size_t> known;
  for (const auto& sample : samples) known[sample.time] = sample.frame;
  auto frames = framesOf(folder, poses, known);

  std::vector<Stamped<Pose>> online;
  if (fs::exists(folder / "trajectory_online.tum")) {
    online = io::readTum(folder / "trajectory_online.tum");
  }
  const auto to_final = corrections(frames, online);
  PathsByFrame paths;
  if (fs::exists(folder / "predictions.csv")) {
    paths = readPredictions(folder / "predictions.csv");
  } else if (!samples.empty()) {
    note("no predictions.csv in " + folder_name + ": drawn without predictions");
  }
  const auto position_of = positionsOf(frames);
  addTracks(samples, paths, position_of, to_final, frames);
  const fs::path smoothed = folder / "tracks_smoothed.csv";
  const auto past = fs::exists(smoothed) ? io::readTrackCsv(smoothed) : std::move(samples);
  addPast(pathsOf(past, position_of, to_final), frames);
  return frames;
}

}  // namespace headway::render_program
