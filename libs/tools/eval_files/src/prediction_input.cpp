// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/core/statistics.h>
#include <headway/eval_files/camera_poses.h>
#include <headway/eval_files/label_files.h>
#include <headway/eval_files/prediction_input.h>
#include <headway/io/calibration_file.h>
#include <headway/io/track_file.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace headway::eval_files {
namespace {

Pose readExtrinsic(const std::string& path) {
  return path.empty() ? robotFromOptical() : io::readCalibration(path).T_robot_cam;
}

/// Rows of one file, grouped by frame and track.
std::vector<eval::TrackPrediction> readPredictions(const std::string& path) {
  std::map<std::tuple<std::size_t, std::int64_t>, eval::TrackPrediction> tracks;
  std::map<std::tuple<std::size_t, std::int64_t, int>, PredictedPath> paths;
  for (const auto& row : io::readPredictionCsv(path)) {
    if (!row.point.position.allFinite() || !row.point.covariance.allFinite() ||
        !std::isfinite(row.time + row.probability)) {
      throw InputError(path + ": frame " + std::to_string(row.frame) + ": a number is not finite");
    }
    auto& track = tracks[{row.frame, row.id.value}];
    track.frame = row.frame;
    track.time = row.time;
    track.id = row.id;
    track.object_class = row.object_class;
    auto& predicted = paths[{row.frame, row.id.value, row.mode}];
    predicted.mode = row.mode;
    predicted.probability = row.probability;
    predicted.points.push_back(row.point);
  }
  for (auto& [key, predicted] : paths) {
    const auto [frame, id, mode] = key;
    if (predicted.points.size() != eval::kHorizons) {
      throw InputError(path + ": frame " + std::to_string(frame) + ", track " + std::to_string(id) +
                       ", mode " + std::to_string(mode) + " has " +
                       std::to_string(predicted.points.size()) +
                       " horizons; 0.1 s, 0.2 s ... 3.0 s are required");
    }
    std::sort(predicted.points.begin(), predicted.points.end(),
              [](const auto& a, const auto& b) { return a.horizon_s < b.horizon_s; });
    tracks[{frame, id}].paths.push_back(std::move(predicted));
  }
  std::vector<eval::TrackPrediction> result;
  for (auto& [key, track] : tracks) result.push_back(std::move(track));
  return result;
}

/// Times of frames: those in the predictions, and evenly spaced times for the other frames.
class FrameTimes {
 public:
  explicit FrameTimes(const std::vector<eval::TrackPrediction>& predictions) {
    for (const auto& prediction : predictions) known_[prediction.frame] = prediction.time;
    std::vector<double> intervals;
    for (auto it = known_.begin(); it != known_.end() && std::next(it) != known_.end(); ++it) {
      const auto [later_frame, later_time] = *std::next(it);
      intervals.push_back((later_time - it->second) / static_cast<double>(later_frame - it->first));
    }
    if (intervals.empty()) return;
    interval_ = median(std::move(intervals));
  }

  [[nodiscard]] double interval() const { return interval_; }

  [[nodiscard]] Time of(std::size_t frame) const {
    if (known_.empty()) return interval_ * static_cast<double>(frame);
    auto nearest = known_.lower_bound(frame);
    if (nearest == known_.end()) --nearest;
    return nearest->second +
           interval_ * (static_cast<double>(frame) - static_cast<double>(nearest->first));
  }

 private:
  std::map<std::size_t, Time> known_;
  double interval_ = kNominalFrameInterval_s;
};

double medianInterval(const std::vector<Stamped<Pose>>& poses) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    intervals.push_back(poses[i].time - poses[i - 1].time);
  }
  if (intervals.empty()) return kNominalFrameInterval_s;
  return median(std::move(intervals));
}

/// Reads the poses of all frames from a file with one row per frame.
void readPoses(const std::string& path, const Pose& T_robot_cam, PredictionSequence& sequence) {
  sequence.T_map_cam = readCameraPoses(path, T_robot_cam);
  if (poseFormatOf(path) == PoseFormat::kTum) {
    sequence.frame_interval_s = medianInterval(sequence.T_map_cam);
    for (const auto& prediction : sequence.predictions) {
      const bool exists = prediction.frame < sequence.T_map_cam.size();
      const double difference =
          exists ? std::abs(sequence.T_map_cam[prediction.frame].time - prediction.time) : 0.0;
      if (exists && difference < 0.5 * sequence.frame_interval_s) continue;
      throw InputError(path + ": row " + std::to_string(prediction.frame) +
                       " is not the pose of frame " + std::to_string(prediction.frame) +
                       "; the file must have one row per frame");
    }
    return;
  }
  const FrameTimes times(sequence.predictions);
  sequence.frame_interval_s = times.interval();
  for (std::size_t k = 0; k < sequence.T_map_cam.size(); ++k) {
    sequence.T_map_cam[k].time = times.of(k);
  }
}

PredictionSequence readSequence(const FilePair& files, const std::string& poses, bool with_estimate,
                                const Pose& T_robot_cam) {
  PredictionSequence sequence;
  sequence.name = files.name;
  if (with_estimate) sequence.predictions = readPredictions(files.estimate);
  readPoses(poses, T_robot_cam, sequence);
  try {
    sequence.objects = eval::trueObjects(readLabels(files.truth), sequence.T_map_cam);
  } catch (const InputError& error) {
    throw InputError(files.truth + " and " + poses + ": " + error.what());
  }
  return sequence;
}

}  // namespace

std::vector<PredictionSequence> readPredictionInput(const PredictionFiles& files) {
  const Pose T_robot_cam = readExtrinsic(files.extrinsic);
  const bool with_estimate = !files.estimate.empty();
  const auto paired = with_estimate ? pairedFiles(files.labels, files.estimate)
                                    : pairedFiles(files.labels, files.poses);
  std::vector<PredictionSequence> sequences;
  for (const auto& pair : paired.pairs) {
    const auto poses = with_estimate ? fileNamed(pair.name, files.poses) : pair.estimate;
    sequences.push_back(readSequence(pair, poses, with_estimate, T_robot_cam));
  }
  return sequences;
}

}  // namespace headway::eval_files
