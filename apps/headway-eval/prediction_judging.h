#pragma once

#include <headway/eval/prediction_plot.h>
#include <headway/eval/text_table.h>
#include <headway/objects/predictor.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "prediction_input.h"

namespace headway::app {

/// What came out for one predictor, or for the predictions of a replay.
struct JudgedPredictor {
  std::string name;
  eval::PredictionJudge judge;  ///< all cases
  eval::PredictionErrors errors;
  std::vector<std::pair<std::string, eval::PredictionErrors>> sequences;
  std::vector<std::pair<std::string, std::size_t>> not_judged;  ///< by reason
  std::size_t drawn_sequence = 0;                               ///< the one with most cases
  std::vector<eval::DrawnPrediction> drawn;                     ///< some of its predictions
};

/// Judges a predictor on exact truth histories.
[[nodiscard]] JudgedPredictor judgePredictor(const std::vector<PredictionSequence>& sequences,
                                             const std::string& name,
                                             const objects::PredictorParams& params);

/// Judges the predictions read with the sequences.
[[nodiscard]] JudgedPredictor judgeEstimate(const std::vector<PredictionSequence>& sequences);

/// One row a predictor: all classes together.
[[nodiscard]] eval::TextTable predictorTable(const std::vector<JudgedPredictor>& judged);
/// One row a predictor, one column a class: ADE / FDE.
[[nodiscard]] eval::TextTable classTable(const std::vector<JudgedPredictor>& judged);
/// One row a sequence, one column a predictor: ADE / FDE.
[[nodiscard]] eval::TextTable sequenceTable(const std::vector<JudgedPredictor>& judged);

}  // namespace headway::app
