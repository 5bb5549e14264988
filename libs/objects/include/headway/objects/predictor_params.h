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
  kMixture,           ///< what the object does now and may do instead, weighted
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
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

/// How one class of objects moves: all that the mixture predictor knows of the world.
struct ManoeuvreParams {
  double memory_s = 2.0;               ///< age at which a place says nothing of the present [s]
  double path_noise_m = 0.1;           ///< by which even exact paths leave a parabola [m]
  double typical_speed = 10.0;         ///< in any direction: a prior [m/s]
  double typical_acceleration = 0.45;  ///< along the path: a prior [m/s^2]
  double typical_turn = 0.75;          ///< acceleration across the path: a prior [m/s^2]
  double acceleration_fade_s = 5.0;    ///< time in which an acceleration fades [s]
  double turn_fade_s = 20.0;           ///< time in which a turn fades [s]
  double standing_speed = 0.5;         ///< slower motion may be noise of a standing object [m/s]
  double cruising_speed = 1.0;         ///< faster, an object manoeuvres freely [m/s]
  double other_acceleration = 1.5;     ///< of the slower and the faster alternative [m/s^2]
  double acceleration_sigma = 1.0;     ///< unforeseen acceleration along the path [m/s^2]
  double lateral_sigma = 0.5;          ///< unforeseen acceleration across the path [m/s^2]

  void describe(Params::Section section, const std::string& prefix);
};

/// Everything that the predictors can be told.
struct PredictorParams {
  PaperPredictorParams paper;
  double velocity_window_s = 0.5;  ///< of constant_velocity and constant_turn [s]
  PerClass<ManoeuvreParams> manoeuvres = {
      {2.0, 0.1, 12.0, 0.42, 0.75, 8.0, 20.0, 0.8, 2.0, 1.5, 1.2, 0.33},
      {1.5, 0.1, 5.0, 0.12, 1.5, 8.0, 1.2, 0.5, 1.8, 1.0, 2.4, 0.5},
      {3.8, 0.1, 1.5, 0.01, 0.08, 1.0, 0.8, 0.35, 2.0, 0.5, 0.43, 0.45}};

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

}  // namespace headway::objects
