#include <headway/core/error.h>
#include <headway/eval/chart.h>
#include <headway/eval/json.h>
#include <headway/eval/prediction_plot.h>
#include <headway/eval/text_table.h>
#include <headway/objects/objects_params.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "outputs.h"
#include "prediction_judging.h"

namespace headway::app {
namespace {

struct Options {
  PredictionFiles files;
  std::string predictor;
  objects::ObjectsParams params;
  bool quiet = false;
  Outputs outputs;
};

bool parse(Options& options, int argc, const char** argv) {
  program::CommandLine line("headway-eval predictions",
                            "Compares predictions with what happened: a replay's own "
                            "(--estimate), or predictors on exact histories (--predictor).");
  Params params;
  options.params.describe(params.section("objects"));
  line.option(options.files.labels, 0, "truth", "LABELS", "KITTI tracking labels: file or folder",
              true);
  line.option(options.files.poses, 0, "poses", "P",
              "Poses of every frame: KITTI (camera) or TUM (robot in map); file or folder", true);
  line.option(options.files.estimate, 0, "estimate", "PREDICTIONS.csv", "File or folder");
  line.option(options.predictor, 0, "predictor", "NAME|all",
              "A predictor, as objects.predictor names it");
  line.option(options.files.extrinsic, 0, "extrinsic", "FILE",
              "calibration.yaml with T_robot_cam; default: axes turned, no offset");
  line.parameters(params);
  options.outputs.describe(line);
  if (!line.parse(argc, argv)) return false;
  if (options.files.estimate.empty() == options.predictor.empty()) {
    throw program::UsageError("give either --estimate or --predictor");
  }
  options.quiet = line.quiet();
  options.outputs.requireWritable();
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

std::vector<JudgedPredictor> judged(const Options& options,
                                    const std::vector<PredictionSequence>& sequences) {
  if (!options.files.estimate.empty()) return {judgeEstimate(sequences)};
  std::vector<JudgedPredictor> result;
  for (const auto& name : chosenPredictors(options.predictor)) {
    result.push_back(judgePredictor(sequences, name, options.params.prediction));
  }
  return result;
}

nlohmann::ordered_json figures(const JudgedPredictor& judged) {
  auto json = eval::toJson(judged.errors);
  for (const auto& [name, errors] : judged.sequences) {
    json["sequences"][name] = eval::toJson(errors);
  }
  for (const auto& [reason, count] : judged.not_judged) json["not_judged"][reason] = count;
  return json;
}

nlohmann::ordered_json figures(const std::vector<JudgedPredictor>& judged) {
  if (judged.size() == 1) return figures(judged.front());
  nlohmann::ordered_json json;
  for (const auto& predictor : judged) json["predictors"][predictor.name] = figures(predictor);
  return json;
}

void report(const std::vector<JudgedPredictor>& judged) {
  if (judged.size() == 1) {
    eval::writeTable(std::cout, eval::tableOf(judged.front().errors));
  } else {
    eval::writeTable(std::cout, predictorTable(judged));
    std::cout << "\nADE / FDE in m by class\n\n";
    eval::writeTable(std::cout, classTable(judged));
    std::cout << "\nADE / FDE in m by sequence\n\n";
    eval::writeTable(std::cout, sequenceTable(judged));
  }
  for (const auto& [reason, count] : judged.front().not_judged) {
    if (count > 0) std::cout << count << " predictions were not judged: " << reason << "\n";
  }
}

cv::Mat plot(const std::vector<PredictionSequence>& sequences,
             const std::vector<JudgedPredictor>& judged) {
  const auto& drawn = judged.front();
  const auto& sequence = sequences[drawn.drawn_sequence];
  std::vector<Eigen::Vector2d> camera_path;
  for (const auto& pose : sequence.T_map_cam) {
    camera_path.emplace_back(pose.value.translation().head<2>());
  }
  std::vector<std::pair<std::string, eval::PredictionError>> lines;
  for (const auto& predictor : judged) lines.emplace_back(predictor.name, predictor.errors.all);
  return eval::stacked({eval::predictionMapPlot(drawn.name + ", sequence " + sequence.name,
                                                sequence.objects, drawn.drawn, camera_path),
                        eval::errorOverHorizonPlot(lines)});
}

}  // namespace

int runPredictions(int argc, const char** argv) {
  Options options;
  if (!parse(options, argc, argv)) return program::kDone;
  if (!options.predictor.empty()) (void)chosenPredictors(options.predictor);
  const auto sequences = readPredictionInput(options.files);
  const auto results = judged(options, sequences);
  if (results.front().errors.all.cases == 0) {
    throw InputError(options.files.labels +
                     ": no object is labelled for 2 s before and 3 s after a frame, or no "
                     "prediction is near one; nothing can be judged");
  }
  if (!options.quiet) report(results);
  options.outputs.write([&] { return figures(results); }, [&] { return plot(sequences, results); });
  return program::kDone;
}

}  // namespace headway::app
