// SPDX-License-Identifier: BSD-3-Clause
#include <headway/eval/figures.h>
#include <headway/eval/labelled_frames.h>
#include <headway/eval/plots.h>
#include <headway/eval/prediction_evaluation.h>
#include <headway/objects/objects_params.h>
#include <headway/plot/chart.h>
#include <headway/plot/text_table.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"

namespace headway::app {
namespace {

using eval::EvaluatedPredictor;
using eval::PredictionSequence;

struct PredictionsOptions {
  eval::PredictionFiles files;
  std::string predictor;
  bool coverage = false;
  objects::ObjectsParams params;
  bool quiet = false;
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
            "class, speed and range");
  line.option(options.files.extrinsic, 0, "extrinsic", "FILE",
              "calibration.yaml with T_robot_cam; default: robot axes at the camera");
  line.parameters(params);
  options.outputs.describe(line);
  if (!line.parse(argc, argv)) return false;
  if (options.files.estimate.empty() == options.predictor.empty()) {
    throw program::UsageError("exactly one of --estimate and --predictor is required");
  }
  options.quiet = line.quiet();
  options.outputs.requireWritable(
      {options.files.labels, options.files.poses, options.files.estimate, options.files.extrinsic});
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
  std::vector<Eigen::Vector2d> camera_path;
  for (const auto& pose : sequence.T_map_cam) {
    camera_path.emplace_back(pose.value.translation().head<2>());
  }
  std::vector<std::pair<std::string, eval::PredictionError>> lines;
  for (const auto& predictor : predictors) lines.emplace_back(predictor.name, predictor.errors.all);
  return plot::stacked(
      {eval::predictionMapPlot(
           recordingName(eval::fileNamed(sequence.name, labels)) + ": " + drawn.name,
           sequence.objects, drawn.drawn, camera_path),
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
  if (!options.quiet) report(results, options.coverage);
  options.outputs.write([&] { return figures(results); },
                        [&] { return plot(options.files.labels, sequences, results); });
  return program::kDone;
}

}  // namespace headway::app
