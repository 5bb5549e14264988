#pragma once

#include <headway/core/params.h>
#include <headway/objects/per_class.h>
#include <headway/objects/predictor_params.h>

namespace headway::objects {

/// Which detections are believed, and which of them are the same object (Sec. III-C3).
struct ConsistencyParams {
  double min_score = -1000.0;        ///< detections below are left out [detector's scale]
  double max_range_m = 200.0;        ///< detections farther away are left out [m]
  bool track_unknown = true;         ///< track detections of unknown class too
  double gate_sigma = 4.0;           ///< radius of the gate, in standard deviations [-]
  double new_object_density = 0.01;  ///< new objects and false alarms in a place [1/m^2]
  double gate_blur_m = 0.3;          ///< added to the spread of every expected place [m]
  double gate_max_m = 8.0;           ///< largest radius of the gate [m]
  double duplicate_distance =
      0.35;  ///< centres nearer than this share of the width: one object [-]
  double duplicate_overlap_3d = 0.4;  ///< 3D boxes overlapping more (IoU): one object [-]
  double duplicate_overlap_2d = 0.8;  ///< 2D boxes overlapping more (IoU): one object [-]
  double rival_distance_m = 0.5;  ///< nearer tracks of other kinds: only the surest is shown [m]
  double hint_bonus = 1.0;        ///< taken off the cost where the detector's id agrees [-]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

/// How objects move and how well they are measured (Sec. III-C2).
struct FilterParams {
  PerClass<double> acceleration_sigma = {1.0, 0.8, 0.5};    ///< manoeuvres [m/s^2]
  PerClass<double> initial_speed_sigma = {10.0, 5.0, 1.5};  ///< of a new object [m/s]
  double standing_share = 0.3;           ///< of the acceleration, for an object that stands [-]
  double acceleration_time_s = 1.0;      ///< correlation time of an acceleration [s]
  double position_sigma_m = 0.12;        ///< of a measured centre, near [m]
  double position_sigma_per_m = 0.006;   ///< growth with depth, along the ray [m/m]
  double across_share = 0.5;             ///< noise across the ray, share of that along it [-]
  double vertical_sigma_m = 0.1;         ///< of a measured height above ground [m]
  double least_position_sigma_m = 0.05;  ///< added to what a detector claims of itself [m]
  double yaw_sigma_rad = 0.15;           ///< of a measured heading [rad]
  double noise_adaption = 0.02;          ///< share of a surprise that changes the noise scale [-]
  double size_sigma_m = 0.2;             ///< of a measured length, width or height [m]
  double size_settled_m = 0.05;          ///< a size known this well is kept [m]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

/// Which way an object faces, from evidence over frames.
struct HeadingParams {
  double flip_probability = 0.08;  ///< that a detector confuses front and back [-]
  double evidence_to_turn = 6.0;   ///< log-odds needed to turn a track round [-]
  double evidence_limit = 20.0;    ///< log-odds at which evidence saturates [-]
  double settle_frames = 10.0;     ///< measurements that fix the heading of a standing object

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

/// What says that an object moves.
struct MotionVerdictParams {
  PerClass<double> moving_speed = {0.8, 0.6, 0.4};  ///< moving above [m/s]
  PerClass<double> still_speed = {0.4, 0.3, 0.2};   ///< standing below [m/s]
  double significance = 3.0;  ///< speed over its standard deviation to call it moving [-]
  double still_time_s = 0.5;  ///< time below still_speed before an object stands [s]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

/// Priors that smooth a grown track (Sec. III-C1).
enum class MotionPriorKind {
  kLeastKinetic,  ///< eq. (5): squared velocities; pulls towards the past
  kLeastForce,    ///< squared accelerations: no lag at constant velocity
};

/// How tracks are smoothed (Sec. III-C1 and III-C2).
struct SmoothingParams {
  MotionPriorKind motion_prior = MotionPriorKind::kLeastForce;
  int grown_length = 7;         ///< tau_KF: tracks at least this long are grown
  double filter_weight = 0.5;   ///< w_k, of the filter for young tracks [-]
  double average_weight = 0.5;  ///< w_n, of the moving average for young tracks [-]
  int average_points = 3;       ///< n of the moving average
  int window = 20;              ///< h, frames that the motion prior smooths
  PerClass<double> kinetic_weight = {1900.0, 500.0, 80.0};  ///< r, as the paper sets it [kg]
  double kinetic_scale = 1e-3;  ///< from r to a weight against measurements [1/J]
  PerClass<double> force_sigma = {1.5, 1.2, 0.8};  ///< typical acceleration [m/s^2]
  double force_standing_share = 0.2;               ///< of that, for an object that stands [-]
  double force_time_s = 0.3;        ///< time over which such an acceleration lasts [s]
  double outlier_sigma = 3.0;       ///< residual beyond which a place counts less (Huber) [-]
  bool gaussian_smoothing = false;  ///< blur each new place over its predecessors, as in the paper
  double gaussian_sigma_s = 0.1;    ///< width of that blur [s]
  int max_iterations = 10;          ///< of Levenberg-Marquardt
  double settled_m = 0.001;         ///< it ends when no place moves farther [m]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

/// Birth, life and end of tracks.
struct LifecycleParams {
  int confirm_hits = 2;  ///< detections that a confirmed track must have had
  PerClass<double> confirm_score = {-2.0, 2.0, 2.0};  ///< that their scores must add up to [-]
  int confirm_anyway_hits = 6;  ///< detections that confirm a track whatever they scored
  double start_score = -1.0;    ///< less sure detections start no track [detector's scale]
  double score_prior = 5.0;     ///< frames of score 0 that every track starts with
  double coast_share = 1.0;     ///< frames unseen that each frame seen allows [-]
  double coast_sigma_m = 0.6;   ///< and only while its place is known this well [m]
  PerClass<double> coast_score = {0.1, 0.5, 0.4};  ///< and only if it scores this [detector's]
  double tentative_time_s = 0.35;                  ///< a tentative track unseen for longer ends [s]
  double coast_time_s = 0.4;    ///< a confirmed track unseen for longer is no longer shown [s]
  double retrack_time_s = 1.5;  ///< and unseen for longer than this it ends for good [s]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

/// All parameters of the moving-object layer, section "objects".
struct ObjectsParams {
  PredictorKind predictor = PredictorKind::kMixture;
  PredictorParams prediction;
  ConsistencyParams consistency;
  FilterParams filter;
  HeadingParams heading;
  MotionVerdictParams verdict;
  SmoothingParams smoothing;
  LifecycleParams lifecycle;

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

}  // namespace headway::objects
