// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/eval/figures.h>
#include <headway/eval_files/prediction_evaluation.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

namespace headway::eval_files {
namespace {

constexpr std::size_t kDrawEvery = 15;     // frames between drawn predictions of an object
constexpr std::size_t kMaxDrawn = 50;      // more would cover the paths
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

/// Intervals of a quantity: below limits[0], from there to limits[1] ... above the last.
struct Intervals {
  std::vector<double> limits;
  std::string unit;

  [[nodiscard]] std::size_t of(double value) const {
    return static_cast<std::size_t>(std::upper_bound(limits.begin(), limits.end(), value) -
                                    limits.begin());
  }
  [[nodiscard]] std::string name(std::size_t index) const {
    const auto text = [&](std::size_t i) { return plot::fixedText(limits[i], 1); };
    if (index == 0) return "below " + text(0) + " " + unit;
    if (index == limits.size()) return "from " + text(index - 1) + " " + unit;
    return text(index - 1) + " to " + text(index) + " " + unit;
  }
};

/// Cases of each class by one quantity.
class CasesByQuantity {
 public:
  explicit CasesByQuantity(Intervals intervals) : intervals_(std::move(intervals)) {}

  void add(ObjectClass object_class, double value, const std::vector<PredictedPath>& paths,
           const eval::HorizonPath& future) {
    cases_[{object_class, intervals_.of(value)}].add(object_class, paths, future);
  }

  void appendTo(std::vector<PredictionGroup>& groups) const {
    for (const auto& [key, evaluator] : cases_) {
      groups.push_back({std::string(toString(key.first)) + ", " + intervals_.name(key.second),
                        evaluator.errors()});
    }
  }

 private:
  Intervals intervals_;
  std::map<std::pair<ObjectClass, std::size_t>, eval::PredictionEvaluator> cases_;
};

/// True speed over the first second after the prediction [m/s].
double speedOf(const eval::HorizonPath& future) {
  constexpr std::size_t kSecond = 9;  // index of 1.0 s
  return (future[kSecond] - future.front()).norm() / (eval::kHorizonStep_s * kSecond);
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
           const eval::HorizonPath& future, const Pose& T_map_cam) {
    sequence_.add(object_class, paths, future);
    by_speed_.add(object_class, speedOf(future), paths, future);
    const double range = (T_map_cam.translation().head<2>() - future.front()).norm();
    by_range_.add(object_class, range, paths, future);
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
    by_speed_.appendTo(result_.groups);
    by_range_.appendTo(result_.groups);
    return std::move(result_);
  }

 private:
  EvaluatedPredictor result_;
  eval::PredictionEvaluator all_;
  eval::PredictionEvaluator sequence_;
  CasesByQuantity by_speed_{Intervals{{0.5, 2.0, 4.0, 8.0, 16.0}, "m/s"}};
  CasesByQuantity by_range_{Intervals{{10.0, 20.0, 30.0, 50.0}, "m"}};
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
      collector.add(object_class, item.object, now.frame, now.position, paths, item.future,
                    sequences[s].T_map_cam[now.frame].value);
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
                    item.future, sequences[s].T_map_cam[prediction.frame].value);
    }
    collector.end(sequences[s].name, s);
  }
  auto result = collector.result();
  result.not_evaluated = {{"no object of their class is near", unmatched},
                          {"the truth ends within 3 s", cut_short}};
  return result;
}

void requireCases(const EvaluatedPredictor& predictor, const std::string& labels) {
  if (predictor.errors.all.cases > 0) return;
  throw InputError(labels +
                   ": nothing to evaluate: no object is labelled for 2 s before and 3 s after a "
                   "frame, or no prediction is near one");
}

nlohmann::ordered_json toJson(const EvaluatedPredictor& predictor) {
  auto json = eval::toJson(predictor.errors);
  for (const auto& [name, errors] : predictor.sequences) {
    json["sequences"][name] = eval::toJson(errors);
  }
  for (const auto& group : predictor.groups) {
    json["groups"][group.name] = eval::toJson(group.errors).at("all");
  }
  for (const auto& [reason, count] : predictor.not_evaluated) json["not_judged"][reason] = count;
  return json;
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

plot::TextTable coverageTable(const EvaluatedPredictor& predictor) {
  plot::TextTable table = {
      {"cases of", "cases", "ADE m", "FDE m", "in 90% 1s", "in 90% 2s", "in 90% 3s"}};
  const auto add = [&table](const std::string& name, const eval::PredictionError& error) {
    table.push_back({name, std::to_string(error.cases), plot::fixedText(error.ade_m, 3),
                     plot::fixedText(error.fde_m, 3)});
    constexpr std::size_t kNinety = 1;  // index in PredictionError::coverage
    for (const auto& ratio : error.coverage[kNinety]) {
      table.back().push_back(plot::percentText(ratio, 1));
    }
  };
  for (const auto& [name, errors] : predictor.sequences) {
    if (errors.all.cases > 0) add("sequence " + name, errors.all);
  }
  for (const auto& group : predictor.groups) add(group.name, group.errors.all);
  add("all", predictor.errors.all);
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

}  // namespace headway::eval_files
