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

/// What a predictor is told: where one object was, and what it is.
struct MotionHistory {
  ObjectClass object_class = ObjectClass::kUnknown;
  /// Past places, oldest first; the last one is now. Times must increase; `frame` is not read.
  std::vector<TrajectoryPoint> path;
  /// Of each place's noise, over the ground [m^2]; zero if the places are exact.
  Eigen::Matrix2d position_covariance = Eigen::Matrix2d::Zero();
};

/// Foretells the path of one object over the next 3 s.
///
/// Every predictor obeys these laws: sample j lies at the horizon (j+1) * 0.1 s; z is held; the
/// covariance never shrinks with the horizon; probabilities sum to one and fall from path to path;
/// no history gives no path, a history of one place gives a path that stays there; turning and
/// shifting the history turns and shifts the prediction.
///
///     auto predictor = makePredictor(PredictorKind::kPaper, PredictorParams());
///     std::vector<PredictedPath> paths = predictor->predict(history);
class Predictor {
 public:
  virtual ~Predictor() = default;

  /// Writes the paths into `paths`, using again the memory it holds.
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
