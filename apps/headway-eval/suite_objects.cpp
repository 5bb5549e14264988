// SPDX-License-Identifier: BSD-3-Clause
#include "suite_objects.h"

#include <headway/eval/labelled_frames.h>
#include <headway/eval/prediction_error.h>
#include <headway/eval/prediction_evaluation.h>
#include <headway/objects/predictor.h>
#include <headway/pipeline/moving_regions.h>

#include <cmath>
#include <map>

namespace headway::app {
namespace {

constexpr double kMaxGap_s = 0.25;  // of a true path to interpolate over

/// Tracks and predictions of one recording.
struct TrackingRun {
  std::vector<eval::LabelledFrame> tracks;  ///< estimates only, optical frame
  std::vector<eval::TrackPrediction> predictions;
};

eval::LabelledBox boxOf(const Track& track, const Pose& T_cam_map,
                        const std::optional<StereoCamera>& camera) {
  eval::LabelledBox box;
  box.id = track.id.value;
  box.object_class = track.object_class;
  box.score = track.score;
  box.box3d = opticalBox(track.position, track.size, track.yaw, T_cam_map);
  box.box2d = track.box2d;
  if (!box.box2d && camera) box.box2d = pipeline::projectedBox(*box.box3d, *camera);
  return box;
}

TrackingRun runTracking(const ObjectRecording& recording, const objects::ObjectsParams& params) {
  pipeline::PerceptionParams perception_params;
  perception_params.objects = params;
  pipeline::Perception perception(nullptr, perception_params);
  TrackingRun run;
  std::map<std::int64_t, double> scores;
  for (const auto& frame : recording.frames) {
    const auto update = perception.process(frame);
    if (run.tracks.size() <= frame.index) run.tracks.resize(frame.index + 1);
    const Pose T_cam_map = (update.camera.T_map_robot * recording.T_robot_cam).inverse();
    for (const auto& track : update.objects.tracks) {
      if (!isShown(track)) continue;
      run.tracks[frame.index].estimates.push_back(boxOf(track, T_cam_map, recording.camera));
      scores[track.id.value] = track.score;
      if (track.predictions.empty()) continue;
      run.predictions.push_back(
          {frame.index, frame.time, track.id, track.object_class, track.predictions});
    }
  }
  for (auto& frame : run.tracks) {  // one score per track, as in tracks_kitti.txt
    for (auto& box : frame.estimates) box.score = scores.at(box.id);
  }
  return run;
}

/// Combines the recording's labels with estimates.
eval::LabelledSequence withLabels(const ObjectRecording& recording,
                                  std::vector<eval::LabelledFrame> frames) {
  frames.resize(std::max(frames.size(), recording.labels.size()));
  for (std::size_t k = 0; k < recording.labels.size(); ++k) {
    frames[k].truth = recording.labels[k].truth;
    frames[k].dont_care = recording.labels[k].dont_care;
  }
  return {recording.name, std::move(frames)};
}

std::vector<eval::LabelledFrame> rawBoxes(const ObjectRecording& recording) {
  std::vector<eval::LabelledFrame> frames;
  std::int64_t next_id = -1;
  for (const auto& frame : recording.frames) {
    if (frames.size() <= frame.index) frames.resize(frame.index + 1);
    if (!frame.detections) continue;
    for (const auto& detection : frame.detections->items) {
      eval::LabelledBox box;
      box.id = next_id--;
      box.object_class = detection.object_class;
      box.score = detection.score;
      box.box2d = detection.box2d;
      box.box3d = detection.box3d;
      frames[frame.index].estimates.push_back(box);
    }
  }
  return frames;
}

/// Camera pose at each frame index; frames without a pose repeat the previous one.
std::vector<Stamped<Pose>> cameraPoses(const ObjectRecording& recording) {
  std::vector<Stamped<Pose>> poses;
  for (const auto& frame : recording.frames) {
    if (!frame.T_map_robot) continue;
    while (poses.size() < frame.index) {
      const auto previous =
          poses.empty() ? Stamped<Pose>{frame.time, *frame.T_map_robot} : poses.back();
      poses.push_back({previous.time + eval::kNominalFrameInterval_s, previous.value});
    }
    poses.push_back({frame.time, *frame.T_map_robot * recording.T_robot_cam});
  }
  while (!poses.empty() && poses.size() < recording.labels.size()) {
    poses.push_back({poses.back().time + eval::kNominalFrameInterval_s, poses.back().value});
  }
  return poses;
}

eval::PredictionEvaluator evaluateOnTracks(const std::vector<eval::TrueObject>& truth,
                                           const TrackingRun& run) {
  eval::PredictionEvaluator evaluator;
  for (const auto& item :
       eval::trackCases(truth, run.predictions, eval::kMatchDistance_m, kMaxGap_s).cases) {
    const auto& prediction = run.predictions[item.prediction];
    evaluator.add(prediction.object_class, prediction.paths, item.future);
  }
  return evaluator;
}

}  // namespace

ObjectFigures runTracks(const ObjectRecording& recording, const objects::ObjectsParams& params) {
  ObjectFigures figures;
  figures.raw = {withLabels(recording, rawBoxes(recording))};
  figures.tracks = {withLabels(recording, runTracking(recording, params).tracks)};
  return figures;
}

ObjectFigures runObjects(const ObjectRecording& recording, const objects::ObjectsParams& params) {
  ObjectFigures figures = runTracks(recording, params);
  eval::PredictionSequence truth;
  truth.name = recording.name;
  truth.T_map_cam = cameraPoses(recording);
  truth.objects = eval::trueObjects(recording.labels, truth.T_map_cam);
  for (const auto& name : objects::predictorNames()) {
    auto with_predictor = params;
    with_predictor.predictor = objects::predictorKindFrom(name);
    figures.on_tracks.emplace_back(
        name, evaluateOnTracks(truth.objects, runTracking(recording, with_predictor)));
    figures.on_truth.emplace_back(
        name, eval::evaluatePredictor({truth}, name, params.prediction).evaluator);
  }
  return figures;
}

void add(const ObjectFigures& other, ObjectFigures& together) {
  together.raw.insert(together.raw.end(), other.raw.begin(), other.raw.end());
  together.tracks.insert(together.tracks.end(), other.tracks.begin(), other.tracks.end());
  const auto add_evaluators = [](const PredictorEvaluators& from, PredictorEvaluators& to) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      if (to.size() <= i) to.push_back({from[i].first, {}});
      to[i].second.add(from[i].second);
    }
  };
  add_evaluators(other.on_tracks, together.on_tracks);
  add_evaluators(other.on_truth, together.on_truth);
}

}  // namespace headway::app
