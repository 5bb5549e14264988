// SPDX-License-Identifier: BSD-3-Clause
// headway-eval tracks, movers, people and predictions: objects of a replay against the truth.
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/eval/figures.h>
#include <headway/eval/labelled_frames.h>
#include <headway/eval/moving_object_error.h>
#include <headway/eval/people_error.h>
#include <headway/eval/plots.h>
#include <headway/eval/prediction_evaluation.h>
#include <headway/eval/track_error.h>
#include <headway/objects/objects_params.h>
#include <headway/plot/chart.h>
#include <headway/plot/text_table.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands.h"

namespace headway::app {
namespace {

using eval::TrackEvaluation;

std::vector<Eigen::Vector2d> pathOf(const std::vector<Stamped<Pose>>& poses) {
  std::vector<Eigen::Vector2d> path;
  for (const auto& pose : poses) path.emplace_back(pose.value.translation().head<2>());
  return path;
}

struct TracksOptions {
  std::string truth;
  std::string estimate;
  std::string metric = "3d";
  std::string classes = "Car,Pedestrian,Cyclist";
  std::string raw;
  std::string poses;
  std::optional<double> min_overlap;
  Outputs outputs;
};

std::vector<ObjectClass> chosenClasses(const std::string& list) {
  std::vector<ObjectClass> classes;
  for (const std::string& word : program::split(list)) {
    const auto object_class = objectClassFrom(word);
    if (!object_class) throw program::UsageError("--classes: '" + word + "' is not a KITTI class");
    classes.push_back(*object_class);
  }
  if (classes.empty()) throw program::UsageError("--classes: the list is empty");
  return classes;
}

eval::TrackErrorParams paramsFrom(const TracksOptions& options) {
  eval::TrackErrorParams params;
  params.classes = chosenClasses(options.classes);
  if (options.metric == "2d") {
    params.metric = eval::BoxMetric::k2d;
    params.min_overlap = 0.5;
  } else if (options.metric != "3d") {
    throw program::UsageError("--metric: '" + options.metric + "' is neither 2d nor 3d");
  }
  if (options.min_overlap) params.min_overlap = *options.min_overlap;
  if (!(params.min_overlap > 0.0 && params.min_overlap <= 1.0)) {
    throw program::UsageError("--iou must be above 0 and at most 1");
  }
  return params;
}

bool parseTracks(TracksOptions& options, int argc, const char** argv) {
  program::CommandLine line("headway-eval tracks",
                            "Evaluates tracks against labels: positions, CLEAR MOT, HOTA, sAMOTA.");
  double overlap = -1.0;
  line.option(options.truth, 0, "truth", "LABELS",
              "KITTI tracking labels, or the objects.csv of a simulation: a file or a folder",
              true);
  line.option(options.estimate, 0, "estimate", "TRACKS",
              "KITTI tracking results, or a tracks.csv: a file, or a folder with files of the same "
              "names",
              true);
  line.option(options.metric, 0, "metric", "2d|3d", "Compare 2D or 3D boxes; default 3d");
  line.option(overlap, 0, "iou", "X", "Minimum overlap of a match; default 0.25 (3d), 0.5 (2d)");
  line.option(options.classes, 0, "classes", "Car,...",
              "Classes to evaluate; default Car,Pedestrian,Cyclist");
  line.option(options.raw, 0, "raw", "DETECTIONS",
              "Also evaluate the positions of raw detections: file, rawlog or folder");
  line.option(options.poses, 0, "poses", "P",
              "Pose of every frame (KITTI or TUM): --plot then includes a map");
  if (!options.outputs.parse(line, argc, argv,
                             {&options.truth, &options.estimate, &options.raw, &options.poses}))
    return false;
  if (overlap != -1.0) options.min_overlap = overlap;
  return true;
}

void report(const TrackEvaluation& results) {
  plot::writeTable(std::cout, eval::tableOf(results.tracks));
  if (results.raw) {
    std::cout << "\nPositions, raw detections / tracks\n\n";
    plot::writeTable(std::cout, eval::positionTable(*results.raw, results.tracks));
  }
  if (!results.truth_alone.empty()) {
    std::cout << results.truth_alone.size() << " label files have no estimate and were ignored:";
    for (const auto& name : results.truth_alone) std::cout << " " << printable(name);
    std::cout << "\n";
  }
  for (const auto& [reason, count] : results.dropped) {
    std::cout << count << " rows of the estimate were ignored: " << reason << "\n";
  }
}

/// Map of the sequence with the most labels.
cv::Mat mapPlot(const TracksOptions& options, const TrackEvaluation& results) {
  const auto boxes = [](const eval::LabelledSequence& sequence) {
    std::size_t count = 0;
    for (const auto& frame : sequence.frames) count += frame.truth.size();
    return count;
  };
  const auto sequence =
      std::max_element(results.sequences.begin(), results.sequences.end(),
                       [&](const auto& a, const auto& b) { return boxes(a) < boxes(b); });
  const auto T_map_cam =
      eval::readCameraPoses(eval::fileNamed(sequence->name, options.poses), robotFromOptical());
  eval::TrackMap map{recordingName(eval::fileNamed(sequence->name, options.estimate)) + ": tracks",
                     eval::trueObjects(sequence->frames, T_map_cam),
                     eval::estimatedObjects(sequence->frames, T_map_cam),
                     {},
                     {}};
  if (!results.raw_sequences.empty()) {
    const auto index = static_cast<std::size_t>(sequence - results.sequences.begin());
    map.raw = eval::estimatedObjects(results.raw_sequences[index].frames, T_map_cam);
  }
  map.camera_path = pathOf(T_map_cam);
  return eval::trackMapPlot(map);
}

cv::Mat plot(const TracksOptions& options, const TrackEvaluation& results) {
  const cv::Mat curves =
      eval::trackPlot(recordingName(options.estimate) + ": accuracy over recall", results.tracks);
  return options.poses.empty() ? curves : plot::stacked({mapPlot(options, results), curves});
}

}  // namespace

int runTracks(int argc, const char** argv) {
  TracksOptions options;
  if (!parseTracks(options, argc, argv)) return program::kDone;
  const auto results =
      eval::evaluateTracks({options.truth, options.estimate, options.raw}, paramsFrom(options));
  if (!options.outputs.quiet()) report(results);
  options.outputs.write([&] { return toJson(results); }, [&] { return plot(options, results); });
  return program::kDone;
}

namespace {

void reportTracks(const eval::MovingObjectError& error) {
  std::cout << "\n"
            << error.tracks.size() << " moving tracks in " << error.frames << " frames, "
            << error.false_tracks << " false ("
            << plot::fixedText(error.falseTracksPer100Frames(), 1) << " per 100 frames); "
            << error.duplicate_rows << " rows on an object that has another row\n";
  for (const auto& track : error.tracks) {
    if (track.wrong == 0) continue;
    std::cout << "track " << track.id << " (" << toString(track.object_class) << "), frames "
              << track.first_frame << " to " << track.last_frame << ": " << track.wrong << " of "
              << track.rows << " moving rows are wrong\n";
  }
  for (const auto& [reason, count] : error.ignored) {
    std::cout << count << " moving rows were ignored: " << reason << "\n";
  }
}

void report(const eval::MoverEvaluation& results) {
  plot::writeTable(std::cout, eval::tableOf(results.error));
  reportTracks(results.error);
  const auto& coasting = results.with_coasting.all;
  std::cout << "with coasting tracks: recall " << plot::percentText(coasting.recall(), 1)
            << " %, precision " << plot::percentText(coasting.precision(), 1) << " %\n\n";
  plot::writeTable(std::cout, eval::tableOf(results.labelled));
  const auto motion = [](const std::string& title, const eval::ObjectMotionErrors& errors) {
    std::cout << "\n" << title << "\n\n";
    plot::writeTable(std::cout, eval::tableOf(errors));
  };
  motion("Motion by the tracks' poses", results.motion);
  motion("Motion by the tracks' velocities", results.motion_velocity);
  motion("Motion by the smoothed tracks", results.motion_smoothed);
}

/// Paths of labelled objects and of moving tracks in the world.
cv::Mat plot(const eval::MovingObjectInput& input) {
  auto labels = input.labels;
  labels.resize(std::min(labels.size(), input.T_world_cam.size()));
  eval::TrackMap map{
      "Labels and moving tracks", eval::trueObjects(labels, input.T_world_cam), {}, {}, {}};
  std::map<std::int64_t, eval::TrueObject> tracks;
  for (const auto& row : input.rows) {
    if (!row.moving || row.frame >= input.T_world_cam.size()) continue;
    auto& track = tracks[row.id];
    track.id = row.id;
    track.object_class = row.object_class;
    const auto& [time, T_world_cam] = input.T_world_cam[row.frame];
    track.path.push_back({row.frame, time, T_world_cam * row.centre, 0.0});
  }
  for (auto& [id, track] : tracks) map.tracks.push_back(std::move(track));
  map.camera_path = pathOf(input.T_world_cam);
  return eval::trackMapPlot(map);
}

}  // namespace

int runMovers(int argc, const char** argv) {
  std::string truth, poses, estimate;
  Outputs outputs;
  program::CommandLine line("headway-eval movers",
                            "Evaluates which moving objects a replay finds, its false moving "
                            "tracks, and the objects' motion from frame to frame.");
  line.option(truth, 0, "truth", "LABELS", "KITTI tracking labels", true);
  line.option(poses, 0, "poses", "P",
              "True pose of every frame: KITTI (camera), TUM (robot), or a rawlog with truth_pose",
              true);
  line.option(estimate, 0, "estimate", "OUTDIR", "Output folder of headway-replay", true);
  if (!outputs.parse(line, argc, argv, {&truth, &poses, &estimate})) return program::kDone;
  const auto results = eval::evaluateMovers(truth, poses, estimate);
  if (!outputs.quiet()) report(results);
  outputs.write([&] { return toJson(results); }, [&] { return plot(results.input); });
  return program::kDone;
}

namespace {

using eval::EvaluatedPredictor;
using eval::PredictionSequence;

struct PredictionsOptions {
  eval::PredictionFiles files;
  std::string predictor;
  bool coverage = false;
  objects::ObjectsParams params;
  Outputs outputs;
};

bool parsePredictions(PredictionsOptions& options, int argc, const char** argv) {
  program::CommandLine line("headway-eval predictions",
                            "Evaluates predictions against the true future: those of a replay "
                            "(--estimate), or predictors on exact histories (--predictor).");
  Params params;
  options.params.describe(params.section("objects").user());
  line.option(options.files.labels, 0, "truth", "LABELS", "KITTI tracking labels: file or folder",
              true);
  line.option(options.files.poses, 0, "poses", "P",
              "Pose of every frame: KITTI (camera) or TUM (robot in map); file or folder", true);
  line.option(options.files.estimate, 0, "estimate", "PREDICTIONS.csv",
              "Predictions of a replay: file or folder");
  line.option(options.predictor, 0, "predictor", "NAME|all",
              "Predictor, one of the values of objects.predictor");
  line.flag(options.coverage, 0, "coverage",
            "Also print errors and the ratio of true positions in the 90 % ellipse by sequence, "
            "class, speed, range, and whether they stand, go straight on or turn");
  line.option(options.files.extrinsic, 0, "extrinsic", "FILE",
              "calibration.yaml with T_robot_cam; default: robot axes at the camera");
  line.parameters(params);
  const auto& files = options.files;
  if (!options.outputs.parse(line, argc, argv,
                             {&files.labels, &files.poses, &files.estimate, &files.extrinsic})) {
    return false;
  }
  if (files.estimate.empty() == options.predictor.empty()) {
    throw program::UsageError("exactly one of --estimate and --predictor is required");
  }
  return true;
}

std::vector<std::string> chosenPredictors(const std::string& name) {
  const auto& known = objects::predictorNames();
  if (name == "all") return known;
  if (std::find(known.begin(), known.end(), name) == known.end()) {
    std::string list = "all";
    for (const auto& other : known) list += ", " + other;
    throw program::UsageError("--predictor: '" + name + "' is none of " + list);
  }
  return {name};
}

std::vector<EvaluatedPredictor> evaluate(const PredictionsOptions& options,
                                         const std::vector<PredictionSequence>& sequences) {
  if (!options.files.estimate.empty()) return {eval::evaluateEstimate(sequences)};
  std::vector<EvaluatedPredictor> result;
  for (const auto& name : chosenPredictors(options.predictor)) {
    result.push_back(eval::evaluatePredictor(sequences, name, options.params.prediction));
  }
  return result;
}

nlohmann::ordered_json figures(const std::vector<EvaluatedPredictor>& predictors) {
  if (predictors.size() == 1) return toJson(predictors.front());
  nlohmann::ordered_json json;
  for (const auto& predictor : predictors) json["predictors"][predictor.name] = toJson(predictor);
  return json;
}

void report(const std::vector<EvaluatedPredictor>& predictors, bool coverage) {
  if (predictors.size() == 1) {
    plot::writeTable(std::cout, eval::tableOf(predictors.front().errors));
  } else {
    plot::writeTable(std::cout, eval::predictorTable(predictors));
    std::cout << "\nADE / FDE in m by class\n\n";
    plot::writeTable(std::cout, eval::classTable(predictors));
    std::cout << "\nADE / FDE in m by sequence\n\n";
    plot::writeTable(std::cout, eval::sequenceTable(predictors));
  }
  for (const auto& predictor : predictors) {
    if (!coverage) break;
    std::cout << "\n" << predictor.name << "\n\n";
    plot::writeTable(std::cout, eval::coverageTable(predictor));
  }
  for (const auto& [reason, count] : predictors.front().not_evaluated) {
    if (count > 0) std::cout << count << " predictions were not evaluated: " << reason << "\n";
  }
}

cv::Mat plot(const std::string& labels, const std::vector<PredictionSequence>& sequences,
             const std::vector<EvaluatedPredictor>& predictors) {
  const auto& drawn = predictors.front();
  const auto& sequence = sequences[drawn.drawn_sequence];
  std::vector<std::pair<std::string, eval::PredictionError>> lines;
  for (const auto& predictor : predictors) lines.emplace_back(predictor.name, predictor.errors.all);
  return plot::stacked(
      {eval::predictionMapPlot(
           recordingName(eval::fileNamed(sequence.name, labels)) + ": " + drawn.name,
           sequence.objects, drawn.drawn, pathOf(sequence.T_map_cam)),
       eval::errorOverHorizonPlot(recordingName(labels) + ": mean error over the horizon", lines)});
}

}  // namespace

int runPredictions(int argc, const char** argv) {
  PredictionsOptions options;
  if (!parsePredictions(options, argc, argv)) return program::kDone;
  if (!options.predictor.empty()) (void)chosenPredictors(options.predictor);
  const auto sequences = eval::readPredictionInput(options.files);
  const auto results = evaluate(options, sequences);
  eval::requireCases(results.front(), options.files.labels);
  if (!options.outputs.quiet()) report(results, options.coverage);
  options.outputs.write([&] { return figures(results); },
                        [&] { return plot(options.files.labels, sequences, results); });
  return program::kDone;
}

namespace {

void report(const eval::PeopleError& error) {
  plot::writeTable(std::cout, tableOf(error));
  std::cout << "\n"
            << error.rows << " confirmed rows in " << error.frames << " frames, "
            << error.false_rows << " false (" << plot::percentText(error.falseRatio(), 1) << " %)";
  if (error.rows_without_pose > 0) {
    std::cout << ", " << error.rows_without_pose << " left out: the camera was lost";
  }
  std::cout << "\n"
            << error.person_rows << " rows say person, " << error.person_rows_right << " right ("
            << plot::percentText(error.personRowsRatio(), 1) << " %)\n"
            << error.moving_tracks << " moving tracks, " << error.false_moving_tracks.size()
            << " false (" << plot::fixedText(error.falseTracksPer10Min(), 1) << " in 10 min)\n"
            << error.first_rows_s.size() << " people came into view: a row after "
            << plot::fixedText(error.medianFirstRow_s(), 2) << " s in the median, within 1 s for "
            << plot::percentText(error.withinASecondRatio(), 1) << " %\n";
}

}  // namespace

int runPeople(int argc, const char** argv) {
  std::string replay, truth;
  double reach_m = 0.0;  // that of the replay's rig
  Outputs outputs;
  program::CommandLine line("headway-eval people",
                            "Counts the people of a simulated world that a replay finds, by "
                            "distance, walking and standing, and its false rows.");
  line.positional(replay, "OUTDIR", "Output folder of headway-replay");
  line.option(truth, 0, "truth", "NAME.truth", "Truth folder written by headway-sim", true);
  line.option(reach_m, 0, "reach", "M",
              "Distance up to which people count [m]; default: that of the replay's rig");
  if (!outputs.parse(line, argc, argv, {&truth, &replay})) return program::kDone;
  if (reach_m < 0.0) throw program::UsageError("--reach must not be negative");
  const auto error = eval::evaluatePeople(truth, replay, reach_m);
  if (!outputs.quiet()) report(error);
  outputs.write([&] { return toJson(error); }, [&] { return eval::peoplePlot(error); });
  return program::kDone;
}

}  // namespace headway::app
