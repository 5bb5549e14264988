// SPDX-License-Identifier: BSD-3-Clause
#include <headway/eval/figures.h>
#include <headway/eval_files/movers_evaluation.h>

#include <nlohmann/json.hpp>

#include "movers_input.h"

namespace headway::eval_files {

MoverEvaluation evaluateMovers(const std::string& labels, const std::string& poses,
                               const std::string& replay) {
  MoverEvaluation evaluation;
  evaluation.input = readMoversInput(labels, poses, replay);
  const auto& input = evaluation.input;
  eval::MovingObjectParams params;
  evaluation.error = eval::movingObjectError(input, params);
  evaluation.labelled = eval::labelledObjectError(input, params);
  params.with_coasting = true;
  evaluation.with_coasting = eval::movingObjectError(input, params);
  const auto& matches = evaluation.error.matches;
  using eval::ObjectMotion;
  evaluation.motion = eval::objectMotionErrors(input, matches, ObjectMotion::kPoses);
  evaluation.motion_velocity = eval::objectMotionErrors(input, matches, ObjectMotion::kVelocity);
  evaluation.motion_smoothed =
      eval::objectMotionErrors(withSmoothedRows(input, replay), matches, ObjectMotion::kPoses);
  return evaluation;
}

nlohmann::ordered_json toJson(const MoverEvaluation& evaluation) {
  auto json = eval::toJson(evaluation.error);
  json["with_coasting"] = eval::toJson(evaluation.with_coasting);
  json["labelled"] = eval::toJson(evaluation.labelled);
  json["motion"] = eval::toJson(evaluation.motion);
  json["motion_velocity"] = eval::toJson(evaluation.motion_velocity);
  json["motion_smoothed"] = eval::toJson(evaluation.motion_smoothed);
  return json;
}

}  // namespace headway::eval_files
