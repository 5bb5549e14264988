// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/objects/predictor.h>

#include <algorithm>

#include "bezier_predictor.h"
#include "mixture_predictor.h"
#include "straight_predictors.h"

namespace headway::objects {

const std::vector<std::string>& predictorNames() {
  static const std::vector<std::string> names = {"paper",         "paper_dm",   "paper_hd",
                                                 "paper_sv",      "polynomial", "constant_velocity",
                                                 "constant_turn", "mixture"};
  return names;
}

PredictorKind predictorKindFrom(const std::string& name) {
  const auto& names = predictorNames();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    std::string known;
    for (const std::string& other : names) known += (known.empty() ? "" : "|") + other;
    throw InputError("no predictor is called '" + name + "': choose one of " + known);
  }
  return static_cast<PredictorKind>(found - names.begin());
}

std::unique_ptr<Predictor> makePredictor(PredictorKind kind, const PredictorParams& params) {
  params.validate();
  BezierPredictor::Ablation ablation;
  switch (kind) {
    case PredictorKind::kPaper:
      break;
    case PredictorKind::kPaperDm:
      ablation.distance_is_length = true;
      break;
    case PredictorKind::kPaperHd:
      ablation.detected_heading = true;
      break;
    case PredictorKind::kPaperSv:
      ablation.instant_speed = true;
      break;
    case PredictorKind::kPolynomial:
      return std::make_unique<PolynomialPredictor>(params);
    case PredictorKind::kConstantVelocity:
      return std::make_unique<ConstantVelocityPredictor>(params);
    case PredictorKind::kConstantTurn:
      return std::make_unique<ConstantTurnPredictor>(params);
    case PredictorKind::kMixture:
      return std::make_unique<MixturePredictor>(params);
  }
  return std::make_unique<BezierPredictor>(params, ablation);
}

}  // namespace headway::objects
