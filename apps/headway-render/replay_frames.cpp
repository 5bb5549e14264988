#include "replay_frames.h"

#include <headway/core/error.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

namespace headway::render_program {
namespace {

namespace fs = std::filesystem;

constexpr double kSameTimeS = 1e-4;
constexpr double kPastS = 4.0;

/// Frames that were lost, and so have no row in the trajectory.
std::set<std::size_t> lostFrames(const fs::path& folder) {
  std::ifstream file(folder / "summary.json");
  const auto summary = nlohmann::json::parse(file, nullptr, false);
  std::set<std::size_t> lost;
  if (!summary.is_object() || !summary.contains("lost_frames")) return lost;
  for (const auto& index : summary["lost_frames"]) {
    if (index.is_number_unsigned()) lost.insert(index.get<std::size_t>());
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

/// Rows of the trajectory with the frames they belong to; the tracks' rows, which name time and
/// frame, settle what skipped frames would leave open.
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

/// What moves the online map of each frame onto the final one.
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

void move(const Pose& T_final_online, Track& track) {
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

using PlacesByTrack = std::map<TrackId, std::vector<TrajectoryPoint>>;

/// Where each track was, in the final map, ascending in time.
PlacesByTrack placesOf(const std::vector<TrackSample>& samples,
                       const std::map<std::size_t, std::size_t>& position_of,
                       const std::vector<Pose>& to_final) {
  PlacesByTrack places;
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

/// Gives each track its places in the frames before, as far as they are not too long ago.
void addPast(const PlacesByTrack& places, std::vector<ReplayFrame>& frames) {
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

}  // namespace

std::vector<ReplayFrame> readFrames(const std::string& folder_name, const Note& note) {
  const fs::path folder(folder_name);
  const auto poses = io::readTum(folder / "trajectory.tum");
  if (poses.empty()) throw InputError((folder / "trajectory.tum").string() + ": holds no pose");
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
  std::map<std::size_t, std::size_t> position_of;
  for (std::size_t i = 0; i < frames.size(); ++i) position_of[frames[i].frame] = i;
  for (const auto& sample : samples) {
    const auto position = position_of.find(sample.frame);
    if (position == position_of.end()) continue;  // the camera was lost: nowhere to draw it from
    Track track = sample.track;
    const auto path = paths.find({sample.frame, track.id});
    if (path != paths.end()) track.predictions = path->second;
    move(to_final[position->second], track);
    frames[position->second].tracks.push_back(std::move(track));
  }
  const fs::path smoothed = folder / "tracks_smoothed.csv";
  const auto past = fs::exists(smoothed) ? io::readTrackCsv(smoothed) : std::move(samples);
  addPast(placesOf(past, position_of, to_final), frames);
  return frames;
}

}  // namespace headway::render_program
