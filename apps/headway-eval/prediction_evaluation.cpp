#include "prediction_evaluation.h"

#include <headway/eval/figures.h>

#include <algorithm>
#include <map>

namespace headway::app {
namespace {

constexpr std::size_t kDrawEvery = 15;     // frames between drawn predictions of an object
constexpr std::size_t kMaxDrawn = 50;      // more would cover the paths
constexpr double kMatchDistance_m = 2.0;   // between a prediction and its true object
constexpr double kMinDrawnLength_m = 1.0;  // shorter predictions are not drawn

std::string errorPair(const eval::PredictionError& error) {
  return plot::fixedText(error.ade_m, 3) + " / " + plot::fixedText(error.fde_m, 3);
}

/// An evenly spaced sample, small enough for one picture.
std::vector<eval::DrawnPrediction> thinned(const std::vector<eval::DrawnPrediction>& all) {
  std::vector<eval::DrawnPrediction> kept;
  const std::size_t count = std::min(kMaxDrawn, all.size());
  for (std::size_t i = 0; i < count; ++i) kept.push_back(all[i * all.size() / count]);
  return kept;
}

/// Collects the cases of consecutive sequences.
class CaseCollector {
 public:
  explicit CaseCollector(std::string name) { result_.name = std::move(name); }

  void begin() {
    sequence_ = {};
    drawn_.clear();
  }

  void add(ObjectClass object_class, std::size_t object, std::size_t frame,
           const Eigen::Vector3d& now, const std::vector<PredictedPath>& paths,
           const eval::HorizonPath& future) {
    sequence_.add(object_class, paths, future);
    const bool moves = (paths.front().points.back().position - now).norm() > kMinDrawnLength_m;
    if (moves && frame % kDrawEvery == 0) drawn_.push_back({object, now.head<2>(), paths});
  }

  void end(const std::string& name, std::size_t index) {
    const auto errors = sequence_.errors();
    if (errors.all.cases > max_cases_) {
      max_cases_ = errors.all.cases;
      result_.drawn = thinned(drawn_);
      result_.drawn_sequence = index;
    }
    result_.sequences.emplace_back(name, errors);
    all_.add(sequence_);
  }

  [[nodiscard]] EvaluatedPredictor result() {
    result_.errors = all_.errors();
    result_.evaluator = all_;
    return std::move(result_);
  }

 private:
  EvaluatedPredictor result_;
  eval::PredictionEvaluator all_;
  eval::PredictionEvaluator sequence_;
  std::vector<eval::DrawnPrediction> drawn_;
  std::size_t max_cases_ = 0;
};

}  // namespace

EvaluatedPredictor evaluatePredictor(const std::vector<PredictionSequence>& sequences,
                                     const std::string& name,
                                     const objects::PredictorParams& params) {
  const auto predictor = objects::makePredictor(objects::predictorKindFrom(name), params);
  CaseCollector collector(name);
  std::vector<PredictedPath> paths;
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    collector.begin();
    const auto& truth = sequences[s].objects;
    for (auto& item : eval::historyCases(truth, sequences[s].frame_interval_s)) {
      const auto object_class = truth[item.object].object_class;
      const auto now = item.history.back();
      predictor->predictInto({object_class, std::move(item.history)}, paths);
      collector.add(object_class, item.object, now.frame, now.position, paths, item.future);
    }
    collector.end(sequences[s].name, s);
  }
  return collector.result();
}

EvaluatedPredictor evaluateEstimate(const std::vector<PredictionSequence>& sequences) {
  CaseCollector collector("predictions");
  std::size_t unmatched = 0;
  std::size_t cut_short = 0;
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    collector.begin();
    const auto& predictions = sequences[s].predictions;
    const auto found = eval::trackCases(sequences[s].objects, predictions, kMatchDistance_m,
                                        2.5 * sequences[s].frame_interval_s);
    unmatched += found.unmatched;
    cut_short += found.cut_short;
    for (const auto& item : found.cases) {
      const auto& prediction = predictions[item.prediction];
      const auto& first = prediction.paths.front().points.front().position;
      collector.add(prediction.object_class, item.object, prediction.frame, first, prediction.paths,
                    item.future);
    }
    collector.end(sequences[s].name, s);
  }
  auto result = collector.result();
  result.not_evaluated = {{"no object of their class is near", unmatched},
                          {"the truth ends within 3 s", cut_short}};
  return result;
}

plot::TextTable predictorTable(const std::vector<EvaluatedPredictor>& predictors) {
  plot::TextTable table;
  for (const auto& predictor : predictors) {
    auto rows = eval::tableOf(predictor.errors);
    if (table.empty()) {
      table.push_back(rows.front());
      table.front().front() = "predictor";
    }
    table.push_back(rows.back());  // all classes
    table.back().front() = predictor.name;
  }
  return table;
}

plot::TextTable classTable(const std::vector<EvaluatedPredictor>& predictors) {
  plot::TextTable table = {{"predictor"}};
  for (const auto& [object_class, error] : predictors.front().errors.classes) {
    table.front().push_back(std::string(toString(object_class)) + " (" +
                            std::to_string(error.cases) + ")");
  }
  for (const auto& predictor : predictors) {
    table.push_back({predictor.name});
    for (const auto& [object_class, error] : predictor.errors.classes) {
      table.back().push_back(errorPair(error));
    }
  }
  return table;
}

plot::TextTable sequenceTable(const std::vector<EvaluatedPredictor>& predictors) {
  plot::TextTable table = {{"sequence"}};
  for (const auto& predictor : predictors) table.front().push_back(predictor.name);
  for (std::size_t s = 0; s < predictors.front().sequences.size(); ++s) {
    const auto& [name, first] = predictors.front().sequences[s];
    table.push_back({name + " (" + std::to_string(first.all.cases) + ")"});
    for (const auto& predictor : predictors) {
      table.back().push_back(errorPair(predictor.sequences[s].second.all));
    }
  }
  return table;
}

}  // namespace headway::app
