#include "prediction_judging.h"

#include <algorithm>
#include <map>

namespace headway::app {
namespace {

constexpr std::size_t kDrawEvery = 15;    // frames between two drawn predictions of an object
constexpr std::size_t kMostDrawn = 50;    // more would hide the paths
constexpr double kMatchDistance_m = 2.0;  // between a prediction and the object it is about
constexpr double kWorthDrawing_m = 1.0;   // predictions that stay within this are not drawn

std::string errorPair(const eval::PredictionError& error) {
  return eval::fixedText(error.ade_m, 3) + " / " + eval::fixedText(error.fde_m, 3);
}

/// Evenly chosen ones of the list, so that they can be told apart in a picture.
std::vector<eval::DrawnPrediction> thinned(const std::vector<eval::DrawnPrediction>& all) {
  std::vector<eval::DrawnPrediction> kept;
  const std::size_t count = std::min(kMostDrawn, all.size());
  for (std::size_t i = 0; i < count; ++i) kept.push_back(all[i * all.size() / count]);
  return kept;
}

/// Gathers the cases of one sequence after another.
class Gatherer {
 public:
  explicit Gatherer(std::string name) { result_.name = std::move(name); }

  void begin() {
    sequence_ = {};
    drawn_.clear();
  }

  void add(ObjectClass object_class, std::size_t object, std::size_t frame,
           const Eigen::Vector3d& now, const std::vector<PredictedPath>& paths,
           const eval::HorizonPath& future) {
    sequence_.add(object_class, paths, future);
    const bool moves = (paths.front().points.back().position - now).norm() > kWorthDrawing_m;
    if (moves && frame % kDrawEvery == 0) drawn_.push_back({object, now.head<2>(), paths});
  }

  void end(const std::string& name, std::size_t index) {
    const auto errors = sequence_.errors();
    if (errors.all.cases > most_cases_) {
      most_cases_ = errors.all.cases;
      result_.drawn = thinned(drawn_);
      result_.drawn_sequence = index;
    }
    result_.sequences.emplace_back(name, errors);
    all_.add(sequence_);
  }

  [[nodiscard]] JudgedPredictor result() {
    result_.errors = all_.errors();
    result_.judge = all_;
    return std::move(result_);
  }

 private:
  JudgedPredictor result_;
  eval::PredictionJudge all_;
  eval::PredictionJudge sequence_;
  std::vector<eval::DrawnPrediction> drawn_;
  std::size_t most_cases_ = 0;
};

}  // namespace

JudgedPredictor judgePredictor(const std::vector<PredictionSequence>& sequences,
                               const std::string& name, const objects::PredictorParams& params) {
  const auto predictor = objects::makePredictor(objects::predictorKindFrom(name), params);
  Gatherer gatherer(name);
  std::vector<PredictedPath> paths;
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    gatherer.begin();
    const auto& truth = sequences[s].objects;
    for (auto& a_case : eval::historyCases(truth, sequences[s].frame_interval_s)) {
      const auto object_class = truth[a_case.object].object_class;
      const auto now = a_case.history.back();
      predictor->predictInto({object_class, std::move(a_case.history)}, paths);
      gatherer.add(object_class, a_case.object, now.frame, now.position, paths, a_case.future);
    }
    gatherer.end(sequences[s].name, s);
  }
  return gatherer.result();
}

JudgedPredictor judgeEstimate(const std::vector<PredictionSequence>& sequences) {
  Gatherer gatherer("predictions");
  std::size_t unmatched = 0;
  std::size_t cut_short = 0;
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    gatherer.begin();
    const auto& predictions = sequences[s].predictions;
    const auto found = eval::trackCases(sequences[s].objects, predictions, kMatchDistance_m,
                                        2.5 * sequences[s].frame_interval_s);
    unmatched += found.unmatched;
    cut_short += found.cut_short;
    for (const auto& a_case : found.cases) {
      const auto& prediction = predictions[a_case.prediction];
      const auto& first = prediction.paths.front().points.front().position;
      gatherer.add(prediction.object_class, a_case.object, prediction.frame, first,
                   prediction.paths, a_case.future);
    }
    gatherer.end(sequences[s].name, s);
  }
  auto result = gatherer.result();
  result.not_judged = {{"no object of their class is near", unmatched},
                       {"the truth ends within 3 s", cut_short}};
  return result;
}

eval::TextTable predictorTable(const std::vector<JudgedPredictor>& judged) {
  eval::TextTable table;
  for (const auto& predictor : judged) {
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

eval::TextTable classTable(const std::vector<JudgedPredictor>& judged) {
  eval::TextTable table = {{"predictor"}};
  for (const auto& [object_class, error] : judged.front().errors.classes) {
    table.front().push_back(std::string(toString(object_class)) + " (" +
                            std::to_string(error.cases) + ")");
  }
  for (const auto& predictor : judged) {
    table.push_back({predictor.name});
    for (const auto& [object_class, error] : predictor.errors.classes) {
      table.back().push_back(errorPair(error));
    }
  }
  return table;
}

eval::TextTable sequenceTable(const std::vector<JudgedPredictor>& judged) {
  eval::TextTable table = {{"sequence"}};
  for (const auto& predictor : judged) table.front().push_back(predictor.name);
  for (std::size_t s = 0; s < judged.front().sequences.size(); ++s) {
    const auto& [name, first] = judged.front().sequences[s];
    table.push_back({name + " (" + std::to_string(first.all.cases) + ")"});
    for (const auto& predictor : judged) {
      table.back().push_back(errorPair(predictor.sequences[s].second.all));
    }
  }
  return table;
}

}  // namespace headway::app
