// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/object_class.h>
#include <headway/core/track.h>
#include <headway/objects/predictor_params.h>

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

namespace headway::objects {

/// Time between two samples of a prediction [s].
inline constexpr double kPredictionStep_s = 0.1;
/// Samples of a prediction: 3 s ahead, the horizon of the paper.
inline constexpr int kPredictionSamples = 30;

/// Input of a predictor: the past path and the class of one object.
struct MotionHistory {
  ObjectClass object_class = ObjectClass::kUnknown;
  /// Past positions in the map frame, oldest first, the last one current; times must increase.
  std::vector<TrajectoryPoint> path;
  /// Noise of each position on the ground plane [m^2]; zero for exact positions.
  Eigen::Matrix2d position_covariance = Eigen::Matrix2d::Zero();
};

/// Predicts the path of one object over the next 3 s.
///
/// Laws of every predictor: sample j has the horizon (j+1) * 0.1 s; z is constant; the covariance
/// does not decrease with the horizon; probabilities sum to one and do not increase from path to
/// path; an empty history gives no path, a history of one position a constant path; a rigid motion
/// of the history moves the prediction likewise.
///
///     auto predictor = makePredictor(PredictorKind::kPaper, PredictorParams());
///     std::vector<PredictedPath> paths = predictor->predict(history);
class Predictor {
 public:
  virtual ~Predictor() = default;

  /// Writes the paths into `paths`, reusing its memory.
  virtual void predictInto(const MotionHistory& history,
                           std::vector<PredictedPath>& paths) const = 0;

  /// The paths, the most probable first.
  [[nodiscard]] std::vector<PredictedPath> predict(const MotionHistory& history) const {
    std::vector<PredictedPath> paths;
    predictInto(history, paths);
    return paths;
  }
};

/// The predictor of one kind.
[[nodiscard]] std::unique_ptr<Predictor> makePredictor(PredictorKind kind,
                                                       const PredictorParams& params);

/// Names of all kinds, as `objects.predictor` spells them, in the order of the enumeration.
[[nodiscard]] const std::vector<std::string>& predictorNames();

/// The kind of one name.
///
/// @throws InputError if no predictor has that name
[[nodiscard]] PredictorKind predictorKindFrom(const std::string& name);

}  // namespace headway::objects
