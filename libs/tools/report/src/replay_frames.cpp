// SPDX-License-Identifier: BSD-3-Clause
// A finished replay frame by frame, with its truth and recorded images.
#include <headway/core/error.h>
#include <headway/core/input_files.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/report/replay_frames.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "replay_folder.h"

namespace headway::report {
namespace {

namespace fs = std::filesystem;

constexpr double kSamePoseS = 0.03;

/// Transformation from the truth to the estimated map, from the first poses of equal time.
Pose alignment(const fs::path& path, const std::vector<Stamped<Pose>>& truth,
               const std::vector<ReplayFrame>& frames) {
  for (const auto& frame : frames) {
    for (const auto& pose : truth) {
      if (std::abs(pose.time - frame.time) < kSamePoseS) {
        return frame.T_map_robot * pose.value.inverse();
      }
    }
  }
  throw InputError(path.string() +
                   ": no time agrees with a time of the replay; it may belong to another rawlog");
}

}  // namespace

ReplayTruth readReplayTruth(const fs::path& folder, const std::vector<ReplayFrame>& frames,
                            const Note& note) {
  const fs::path trajectory = folder / "trajectory.tum";
  const fs::path objects = folder / "objects.csv";
  if (!fs::exists(trajectory)) {
    throw InputError(trajectory.string() +
                     ": no such file; --truth requires a folder with trajectory.tum");
  }
  ReplayTruth truth;
  truth.path = io::readTum(trajectory);
  const Pose T_map_truth = alignment(trajectory, truth.path, frames);
  for (auto& pose : truth.path) pose.value = T_map_truth * pose.value;
  if (!fs::exists(objects)) {
    note("the truth has no objects.csv: drawn without true boxes");
    return truth;
  }
  for (const auto& sample : io::readTrackCsv(objects)) {
    truth.objects[sample.frame].push_back(transformed(sample.track, T_map_truth));
  }
  return truth;
}

namespace {

constexpr double kSameFrameS = 1e-4;

/// Frames that were lost, unreliable or late, and so have no row in the trajectory.
std::set<std::size_t> framesWithoutPose(const fs::path& folder) {
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

std::size_t firstFrameOf(const fs::path& folder) {
  std::ifstream file(folder / "replay.json");
  const auto record = nlohmann::json::parse(file, nullptr, false);
  if (!record.is_object()) return 0;
  const auto& options = record.value("options", nlohmann::json::object());
  const auto from = options.find("from_index");
  return from != options.end() && from->is_number_unsigned() ? from->get<std::size_t>() : 0;
}

/// Finds the position of the frame of a time.
class FrameTimes {
 public:
  explicit FrameTimes(const std::vector<Stamped<Pose>>& poses) {
    for (const auto& pose : poses) times_.push_back(pose.time);
  }
  [[nodiscard]] std::optional<std::size_t> positionAt(Time time) const {
    const auto found = std::lower_bound(times_.begin(), times_.end(), time - kSameFrameS);
    if (found == times_.end() || *found > time + kSameFrameS) return std::nullopt;
    return static_cast<std::size_t>(found - times_.begin());
  }

 private:
  std::vector<Time> times_;
};

/// Samples of the file at the times of frames, by position of the frame.
using SamplesByPosition = std::vector<std::vector<TrackSample>>;

/// Order of tracks by their distance to the robot.
auto nearerTo(const Pose& T_map_robot) {
  return [robot = Eigen::Vector3d(T_map_robot.translation())](const Track& a, const Track& b) {
    return (a.position - robot).squaredNorm() < (b.position - robot).squaredNorm();
  };
}

/// Keeps the samples nearest to the robot.
void keepNearest(std::size_t count, const Pose& T_map_robot, std::vector<TrackSample>& samples) {
  const auto is_nearer = nearerTo(T_map_robot);
  std::stable_sort(samples.begin(), samples.end(), [&](const TrackSample& a, const TrackSample& b) {
    return is_nearer(a.track, b.track);
  });
  if (samples.size() > count)
    samples.erase(samples.begin() + static_cast<long>(count), samples.end());
}

/// Reads the samples; of more than `max_boxes` the nearest of each frame, so that all frames
/// together have at most so many, or one each, and never more than thrice as many meanwhile.
SamplesByPosition readSamples(const fs::path& path, const FrameTimes& times,
                              const std::vector<Stamped<Pose>>& poses, std::size_t max_boxes,
                              const Note& note) {
  SamplesByPosition samples(poses.size());
  const std::size_t in_a_frame = std::max<std::size_t>(1, max_boxes / poses.size());
  std::size_t boxes = 0, kept = 0;
  io::visitTrackCsv(path, [&](const TrackSample& sample) {
    const auto position = times.positionAt(sample.time);
    if (!position) return;
    auto& here = samples[*position];
    here.push_back(sample);
    if (++boxes <= max_boxes || here.size() < 2 * in_a_frame) return;
    keepNearest(in_a_frame, poses[*position].value, here);
  });
  if (boxes <= max_boxes) return samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    keepNearest(in_a_frame, poses[i].value, samples[i]);
    kept += samples[i].size();
  }
  note(std::to_string(boxes - kept) + " of " + std::to_string(boxes) +
       " boxes are left out: at most the nearest " + std::to_string(in_a_frame) +
       " of each frame are shown");
  return samples;
}

/// Assigns frame indices to every step-th row of the trajectory; the indices of the tracks' rows
/// resolve skipped frames.
std::vector<ReplayFrame> indexedFrames(const fs::path& folder, const ThinnedPath& path,
                                       const SamplesByPosition& samples) {
  const auto lost = framesWithoutPose(folder);
  std::size_t next = firstFrameOf(folder);
  std::vector<ReplayFrame> frames;
  for (std::size_t i = 0; i < path.poses.size(); ++i) {
    if (!samples[i].empty()) next = samples[i].front().frame;
    while (lost.count(next) != 0) ++next;
    frames.push_back({next++, path.poses[i].time, path.poses[i].value, {}, {}});
    for (std::size_t skipped = 1; skipped < path.step; ++skipped, ++next) {
      while (lost.count(next) != 0) ++next;
    }
  }
  return frames;
}

/// Transformation from the online map to the final map at each frame.
std::vector<Pose> corrections(const fs::path& online, const FrameTimes& times,
                              const std::vector<ReplayFrame>& frames) {
  std::vector<Pose> result(frames.size(), Pose::Identity());
  if (!fs::exists(online)) return result;
  io::visitTum(online, [&](const Stamped<Pose>& pose) {
    const auto position = times.positionAt(pose.time);
    if (position) result[*position] = frames[*position].T_map_robot * pose.value.inverse();
  });
  return result;
}

/// Adds each track to its frame, in the map at that time; tracks of frames without a pose are not
/// read.
void addTracks(const SamplesByPosition& samples, std::vector<ReplayFrame>& frames) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (const auto& sample : samples[i]) frames[i].tracks.push_back(sample.track);
  }
}

Track* trackOf(TrackId id, ReplayFrame& frame) {
  const auto track = std::find_if(frame.tracks.begin(), frame.tracks.end(),
                                  [id](const Track& candidate) { return candidate.id == id; });
  return track == frame.tracks.end() ? nullptr : &*track;
}

void addPredictions(const fs::path& path, const FrameTimes& times, double horizon_step_s,
                    std::vector<ReplayFrame>& frames) {
  const auto add = [&](const io::PredictionRow& row) {
    const auto position = times.positionAt(row.time);
    if (!position) return;
    Track* track = trackOf(row.id, frames[*position]);
    if (track == nullptr) return;
    auto& modes = track->predictions;
    if (modes.empty() || modes.back().mode != row.mode) {
      modes.push_back({row.mode, row.probability, {}});
    }
    modes.back().points.push_back(row.point);
  };
  io::visitPredictionCsv(path, add, horizon_step_s);
}

using PathsByTrack = std::map<TrackId, std::vector<TrajectoryPoint>>;

/// Path of each track in the final map, ascending in time.
PathsByTrack pathsOf(const SamplesByPosition& samples, const std::vector<Pose>& to_final) {
  PathsByTrack paths;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (const auto& sample : samples[i]) {
      const Track track = transformed(sample.track, to_final[i]);
      paths[track.id].push_back({sample.frame, sample.time, track.position, track.yaw});
    }
  }
  return paths;
}

/// Adds to each track its positions of the last `past_s`.
void addPast(const PathsByTrack& paths, double past_s, std::vector<ReplayFrame>& frames) {
  for (auto& frame : frames) {
    for (auto& track : frame.tracks) {
      const auto points = paths.find(track.id);
      if (points == paths.end()) continue;
      for (const auto& point : points->second) {
        if (point.time >= frame.time - past_s && point.time < frame.time - kSameFrameS) {
          track.recent_path.push_back(point);
        }
      }
    }
  }
}

}  // namespace

void sortByDistance(const Pose& T_map_robot, std::vector<Track>& tracks) {
  std::stable_sort(tracks.begin(), tracks.end(), nearerTo(T_map_robot));
}

ReplayInput readReplayInput(const fs::path& folder) {
  std::ifstream file(folder / "replay.json");
  const auto record = nlohmann::json::parse(file, nullptr, false);
  if (!record.is_object()) return {};
  const auto input = record.value("input", nlohmann::json::object());
  const auto textOf = [&](const char* key) {
    const auto value = input.find(key);
    return value != input.end() && value->is_string() ? value->get<std::string>() : std::string();
  };
  return {textOf("rawlog"), textOf("sensor_label")};
}

std::vector<ReplayFrame> readReplayFrames(const fs::path& folder, const ReplayFrameOptions& options,
                                          const Note& note) {
  requireOneRun(folder);
  const ThinnedPath path = readPath(folder / "trajectory.tum", options.max_frames);
  if (path.poses.empty()) {
    throw InputError((folder / "trajectory.tum").string() + ": contains no pose");
  }
  const FrameTimes times(path.poses);
  SamplesByPosition samples(path.poses.size());
  const bool has_tracks = fs::exists(folder / "tracks.csv");
  if (has_tracks) {
    samples = readSamples(folder / "tracks.csv", times, path.poses, options.max_boxes, note);
  } else {
    note("no tracks.csv: drawn without tracks");
  }
  auto frames = indexedFrames(folder, path, samples);
  const auto to_final = corrections(folder / "trajectory_online.tum", times, frames);
  addTracks(samples, frames);
  if (!(options.past_s > 0.0)) samples = {};
  if (fs::exists(folder / "trajectory_odom.tum")) {
    io::visitTum(folder / "trajectory_odom.tum", [&](const Stamped<Pose>& pose) {
      const auto position = times.positionAt(pose.time);
      if (position) frames[*position].T_odom_robot = pose.value;
    });
  }
  if (fs::exists(folder / "predictions.csv")) {
    addPredictions(folder / "predictions.csv", times, options.horizon_step_s, frames);
  } else if (has_tracks) {
    note("no predictions.csv: drawn without predictions");
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].tracks = transformed(std::move(frames[i].tracks), to_final[i]);
  }
  if (!(options.past_s > 0.0)) return frames;
  const fs::path smoothed = folder / "tracks_smoothed.csv";
  if (fs::exists(smoothed)) {  // the same boxes: what is left out was said of tracks.csv
    samples = readSamples(smoothed, times, path.poses, options.max_boxes, [](const auto&) {});
  }
  addPast(pathsOf(samples, to_final), options.past_s, frames);
  return frames;
}

class RecordedImages::Reader {
 public:
  Reader(const std::string& rawlog, const io::RawlogSourceOptions& options)
      : source_(rawlog, options) {}

  [[nodiscard]] bool hasImages() const { return source_.camera() != nullptr; }

  cv::Mat at(std::size_t frame) {
    while (!has_ended_ && (!ahead_ || ahead_->index < frame)) {
      ahead_ = source_.next();
      has_ended_ = !ahead_;
    }
    if (!ahead_ || ahead_->index != frame || !ahead_->stereo) return {};
    const StereoFrame& stereo = *ahead_->stereo;
    return stereo.left_colour.empty() ? stereo.left : stereo.left_colour;
  }

 private:
  io::RawlogSource source_;
  std::optional<RecordedFrame> ahead_;  ///< read ahead
  bool has_ended_ = false;
};

RecordedImages::RecordedImages(const ReplayInput& input, std::size_t first_frame,
                               const Note& note) {
  const std::string without = ": drawn without the camera's image";
  if (input.rawlog.empty()) {
    note("the rawlog is unknown" + without);
    return;
  }
  if (!std::filesystem::exists(input.rawlog)) {
    note(input.rawlog + " does not exist" + without);
    return;
  }
  registerInput(input.rawlog);
  try {
    io::RawlogSourceOptions options;
    options.sensor_label = input.sensor_label;
    options.from_index = first_frame;
    reader_ = std::make_unique<Reader>(input.rawlog, options);
    if (reader_->hasImages()) return;
    note(input.rawlog + " contains no images" + without);
  } catch (const InputError& error) {
    note(error.what() + without);
  }
  reader_.reset();
}

RecordedImages::~RecordedImages() = default;

cv::Mat RecordedImages::at(std::size_t frame) {
  return reader_ != nullptr ? reader_->at(frame) : cv::Mat();
}

}  // namespace headway::report
