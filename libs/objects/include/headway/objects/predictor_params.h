#pragma once

#include <headway/core/params.h>
#include <headway/objects/per_class.h>

#include <string>

namespace headway::objects {

/// The predictors to choose from.
enum class PredictorKind {
  kPaper,             ///< heading-based Bezier curve (Sec. III-B)
  kPaperDm,           ///< its ablation DM: the end always lies |C_p| away
  kPaperHd,           ///< its ablation HD: heading from the detector alone
  kPaperSv,           ///< its ablation SV: speed of the last frame, not smoothed
  kPolynomial,        ///< the paper's baseline: a curve through four past places
  kConstantVelocity,  ///< straight on with the velocity of the last half second
  kConstantTurn,      ///< constant speed and turn rate
  kMixture,           ///< weighted manoeuvres with class-dependent damping
};

/// How the paper's predictor reads a track (Sec. III-B and IV-A).
struct PaperPredictorParams {
  double tangent_weight = 0.9;                      ///< w1, of the path's direction in V_h [-]
  double heading_weight = 0.1;                      ///< w2, of the detected heading in V_h [-]
  double heading_limit_rad = 1.5707963267948966;    ///< tau_theta: heading left out beyond [rad]
  double straight_limit_rad = 0.17453292519943295;  ///< tau_alpha: a path is straight below [rad]
  double recent_weight = 2.0;                       ///< w3, of the recent direction in V_p [-]
  double older_weight = -1.0;                       ///< w4, of the older direction in V_p [-]
  double spacing_s = 1.0;                           ///< between the three places that give V_p [s]
  int speed_samples = 20;                           ///< h: steps over which the speed is averaged
  double speed_factor = 1.0;                        ///< gamma, eq. (1) [-]
  double epsilon_s = 1e-6;                          ///< epsilon, eq. (1) [s]

  void describe(Params::Section section);
};

/// How one class of objects moves: what the mixture predictor knows of the world.
struct ManoeuvreParams {
  double speed_window_s = 0.5;        ///< time over which the velocity is fitted [s]
  double acceleration_gain = 0.6;     ///< share of the measured acceleration believed [-]
  double acceleration_decay_s = 1.0;  ///< time in which an acceleration fades [s]
  double turn_gain = 0.6;             ///< share of the measured turn rate believed [-]
  double turn_decay_s = 1.0;          ///< time in which a turn fades [s]
  double acceleration_sigma = 1.0;    ///< unforeseen acceleration along the path [m/s^2]
  double lateral_sigma = 0.5;         ///< unforeseen acceleration across the path [m/s^2]

  void describe(Params::Section section, const std::string& prefix);
};

/// Everything that the predictors can be told.
struct PredictorParams {
  PaperPredictorParams paper;
  double velocity_window_s = 0.5;  ///< of constant_velocity and constant_turn [s]
  PerClass<ManoeuvreParams> manoeuvres = {{}, {}, {}};

  void describe(Params::Section section);
};

}  // namespace headway::objects
