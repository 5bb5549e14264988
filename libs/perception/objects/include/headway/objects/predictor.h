// SPDX-License-Identifier: BSD-3-Clause
// Prediction of an object's path over the next 3 s, and its parameters.
#pragma once

#include <headway/core/object_class.h>
#include <headway/core/params.h>
#include <headway/core/track.h>
#include <headway/objects/per_class.h>

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

namespace headway::objects {

/// The available predictors.
enum class PredictorKind {
  kPaper,             ///< heading-based Bezier curve (Sec. III-B)
  kPaperDm,           ///< its ablation DM: the end point at distance |C_p|
  kPaperHd,           ///< its ablation HD: heading from the detector alone
  kPaperSv,           ///< its ablation SV: speed of the last frame, not smoothed
  kPolynomial,        ///< the paper's baseline: a curve through four past places
  kConstantVelocity,  ///< straight, with the velocity of the last half second
  kConstantTurn,      ///< constant speed and turn rate
  kMixture,           ///< present motion and its alternatives, weighted
};

/// How the paper's predictor reads a track (Sec. III-B and IV-A).
struct PaperPredictorParams {
  double tangent_weight = 0.9;                      ///< w1, of the path's direction in V_h [-]
  double heading_weight = 0.1;                      ///< w2, of the detected heading in V_h [-]
  double heading_limit_rad = 1.5707963267948966;    ///< tau_theta: limit of a used heading [rad]
  double straight_limit_rad = 0.17453292519943295;  ///< tau_alpha: a path is straight below [rad]
  double recent_weight = 2.0;                       ///< w3, of the recent direction in V_p [-]
  double older_weight = -1.0;                       ///< w4, of the older direction in V_p [-]
  double spacing_s = 1.0;                           ///< between the three places that give V_p [s]
  double speed_time_s = 2.0;  ///< h: time over which the speed is averaged [s]
  double speed_factor = 1.0;  ///< gamma, eq. (1) [-]
  double epsilon_s = 1e-6;    ///< epsilon, eq. (1) [s]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

/// Motion models of vehicles, cyclists and pedestrians in the mixture predictor.
///
/// Chosen by least error and by the ratio in the 90 % ellipses of `headway-eval predictions` on
/// exact histories of KITTI's 19 tracking sequences (tests/bench/predictions.sh,
/// doc/lab/tracking.md), except `setting_off_mps`: pedestrians of simulated streets.
struct ManoeuvreParams {
  using Values = PerClass<double>;
  Values memory_s = {2.0, 1.5, 3.8};  ///< age from which a position has no weight in the fit [s]
  /// The same for an object that has just changed its motion; not so for vehicles, whose paths bend
  /// all along [s].
  Values shortest_memory_s = {2.0, 1.5, 0.5};
  Values path_noise_m = {0.1, 0.1, 0.1};        ///< deviation of an exact path from a parabola [m]
  Values typical_speed_mps = {12.0, 5.0, 1.5};  ///< prior of the speed, any direction [m/s]
  /// Prior of the acceleration along the path [m/s^2].
  Values typical_acceleration_mps2 = {0.42, 0.12, 0.01};
  Values typical_lateral_mps2 = {0.75, 1.5, 0.08};  ///< prior of the acceleration across it [m/s^2]
  Values acceleration_fade_s = {8.0, 8.0, 1.0};     ///< decay time of an acceleration [s]
  Values turn_fade_s = {20.0, 1.2, 0.8};            ///< decay time of a turn [s]
  /// Below, motion may be noise of a static object [m/s].
  Values standing_speed_mps = {0.8, 0.5, 0.35};
  Values setting_off_mps = {0.0, 0.0, 0.5};     ///< unpredicted velocity of what stands [m/s]
  Values cruising_speed_mps = {2.0, 1.8, 2.0};  ///< above, an object manoeuvres freely [m/s]
  Values alternative_mps2 = {1.5, 1.0, 0.5};  ///< of the faster and the slower alternative [m/s^2]
  /// Unpredicted acceleration along the path [m/s^2].
  Values acceleration_sigma_mps2 = {1.2, 2.4, 0.43};
  Values lateral_sigma_mps2 = {0.33, 0.5, 0.45};  ///< unpredicted acceleration across it [m/s^2]

  /// Binds the values of one class.
  void describe(Params::Section section, const std::string& prefix, double Values::*of);
};

/// Parameters of all predictors.
struct PredictorParams {
  PaperPredictorParams paper;
  double velocity_window_s = 0.5;  ///< of constant_velocity and constant_turn [s]
  ManoeuvreParams manoeuvres;

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

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
