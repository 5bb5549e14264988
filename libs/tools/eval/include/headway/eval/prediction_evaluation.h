// SPDX-License-Identifier: BSD-3-Clause
// Evaluation of predictors and of a replay's predictions.
#pragma once

#include <headway/eval/plots.h>
#include <headway/eval/prediction_error.h>
#include <headway/objects/predictor.h>
#include <headway/plot/text_table.h>

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

namespace headway::eval {

/// One recording to evaluate predictions on.
struct PredictionSequence {
  std::string name;
  std::vector<Stamped<Pose>> T_map_cam;  ///< camera pose at each frame
  std::vector<TrueObject> objects;
  std::vector<TrackPrediction> predictions;  ///< empty if predictors are evaluated
  double frame_interval_s = 0.1;
};

/// Input files, or folders whose files are paired by name.
struct PredictionFiles {
  std::string labels;
  std::string poses;      ///< KITTI: camera in the first camera; TUM: robot in map
  std::string estimate;   ///< predictions.csv; empty if predictors are evaluated
  std::string extrinsic;  ///< calibration.yaml with T_robot_cam; empty: robot axes at the camera
};

/// Reads all recordings.
///
/// KITTI poses have no times: frame times are those of the predictions, or 0.1 s apart.
///
/// @throws InputError naming the file that cannot be read or does not match the others
[[nodiscard]] std::vector<PredictionSequence> readPredictionInput(const PredictionFiles& files);

inline constexpr double kMatchDistance_m = 2.0;  ///< between a prediction and its true object

/// Errors of similar cases.
struct PredictionGroup {
  std::string name;
  PredictionErrors errors;
};

/// Errors of one predictor, or of the predictions of a replay.
struct EvaluatedPredictor {
  std::string name;
  PredictionEvaluator evaluator;  ///< all cases
  PredictionErrors errors;
  std::vector<std::pair<std::string, PredictionErrors>> sequences;
  std::vector<PredictionGroup> groups;  ///< of each class by true speed, range, and whether it turns
  std::vector<std::pair<std::string, std::size_t>> not_evaluated;  ///< by reason
  std::size_t drawn_sequence = 0;      ///< index of the sequence with the most cases
  std::vector<DrawnPrediction> drawn;  ///< a sample of its predictions
};

/// Evaluates a predictor on exact true histories.
[[nodiscard]] EvaluatedPredictor evaluatePredictor(const std::vector<PredictionSequence>& sequences,
                                                   const std::string& name,
                                                   const objects::PredictorParams& params);

/// Evaluates the predictions read with the sequences.
[[nodiscard]] EvaluatedPredictor evaluateEstimate(const std::vector<PredictionSequence>& sequences);

/// @throws InputError naming the labels if nothing could be evaluated
void requireCases(const EvaluatedPredictor& predictor, const std::string& labels);

/// The figures of `headway-eval predictions --json`.
[[nodiscard]] nlohmann::ordered_json toJson(const EvaluatedPredictor& predictor);

/// One row per predictor, all classes together.
[[nodiscard]] plot::TextTable predictorTable(const std::vector<EvaluatedPredictor>& predictors);
/// One row per predictor, one column per class: ADE / FDE.
[[nodiscard]] plot::TextTable classTable(const std::vector<EvaluatedPredictor>& predictors);
/// One row per sequence, then per group of similar cases: errors and ratios inside the 90 %
/// ellipse.
[[nodiscard]] plot::TextTable coverageTable(const EvaluatedPredictor& predictor);
/// One row per sequence, one column per predictor: ADE / FDE.
[[nodiscard]] plot::TextTable sequenceTable(const std::vector<EvaluatedPredictor>& predictors);

}  // namespace headway::eval
