// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the tracker.
#pragma once

#include <headway/core/params.h>
#include <headway/objects/per_class.h>
#include <headway/objects/predictor.h>

#include <limits>

namespace headway::objects {

/// Selection of detections and their assignment to tracks (Sec. III-C3).
struct ConsistencyParams {
  double min_score = -1000.0;  ///< of a detection that is used [detector's scale]
  double max_range_m = 200.0;  ///< of a detection that is used [m]
  /// Of detections that are used and tracks that are shown, by what is measured [m]; not
  /// configured.
  double max_depth_m = std::numeric_limits<double>::infinity();
  bool track_unknown = true;                ///< also detections of unknown class
  double gate_sigma = 4.0;                  ///< radius of the gate [standard deviations]
  double new_object_density_per_m2 = 0.01;  ///< density of new objects and false alarms [1/m^2]
  double gate_blur_m = 0.3;                 ///< sigma added to every predicted position [m]
  double max_gate_m = 8.0;                  ///< maximum radius of the gate [m]
  double duplicate_distance_ratio = 0.35;   ///< of centres, over the width: below, one object [-]
  double duplicate_iou_3d = 0.4;            ///< overlap of 3D boxes: above, one object [-]
  double duplicate_iou_2d = 0.8;            ///< overlap of 2D boxes: above, one object [-]
  double duplicate_track_distance_m = 0.5;  ///< nearer tracks of two classes: the best is shown [m]
  double detector_id_bonus = 1.0;           ///< cost reduction if the detector's id agrees [-]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

/// Motion model and measurement noise of the Kalman filter (Sec. III-C2).
struct FilterParams {
  PerClass<double> acceleration_sigma_mps2 = {1.0, 0.8, 0.5};   ///< of manoeuvres [m/s^2]
  PerClass<double> initial_speed_sigma_mps = {10.0, 5.0, 1.5};  ///< of a new object [m/s]
  double standing_acceleration_ratio = 0.3;   ///< of that acceleration, for a static object [-]
  double acceleration_time_s = 1.0;           ///< correlation time of an acceleration [s]
  double position_sigma_m = 0.12;             ///< of a measured centre at zero range [m]
  double position_sigma_per_m = 0.006;        ///< growth with depth, along the ray [m/m]
  double across_sigma_ratio = 0.5;            ///< noise across the ray over that along it [-]
  double vertical_sigma_m = 0.1;              ///< of a measured height above ground [m]
  double additional_position_sigma_m = 0.05;  ///< added to a detector's own covariance [m]
  double yaw_sigma_rad = 0.15;                ///< of a measured heading [rad]
  double noise_adaptation = 0.02;             ///< gain from innovations to the noise scale [-]
  double size_sigma_m = 0.2;           ///< of a measured length, width or height at zero range [m]
  double size_converged_ratio = 0.16;  ///< sigma of a size over that of a measurement: below, fixed

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

/// Estimation of the heading from evidence accumulated over frames.
struct HeadingParams {
  double flip_probability = 0.08;   ///< that a detector confuses front and back [-]
  double flip_log_odds = 6.0;       ///< evidence that reverses a track's heading [log-odds]
  double max_flip_log_odds = 20.0;  ///< limit of the accumulated evidence [log-odds]
  double converged_time_s = 1.0;    ///< of the measurements that fix a static object's heading [s]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

/// Classification of tracks as moving or static.
struct MotionClassParams {
  PerClass<double> moving_speed_mps = {0.8, 0.6, 0.4};  ///< moving above [m/s]
  PerClass<double> static_speed_mps = {0.4, 0.3, 0.2};  ///< static below [m/s]
  double significance = 3.0;   ///< minimum speed of a moving object [standard deviations]
  double static_time_s = 0.5;  ///< time below static_speed_mps until an object is static [s]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

/// Priors that smooth a mature track (Sec. III-C1).
enum class MotionPriorKind {
  kLeastKinetic,  ///< eq. (5): squared velocities; biased towards past positions
  kLeastForce,    ///< squared accelerations: no lag at constant velocity
};

/// Smoothing of trajectories (Sec. III-C1 and III-C2).
struct SmoothingParams {
  MotionPriorKind motion_prior = MotionPriorKind::kLeastForce;
  double mature_time_s = 0.7;   ///< tau_KF: detections of a mature track, at least two [s]
  double filter_weight = 0.5;   ///< w_k, of the filter for shorter tracks [-]
  double average_weight = 0.5;  ///< w_n, of the moving average for shorter tracks [-]
  double average_time_s = 0.3;  ///< n of the moving average [s]
  double window_s = 2.0;        ///< h, smoothed by the motion prior [s]
  PerClass<double> kinetic_weight_kg = {1900.0, 500.0, 80.0};  ///< r of the paper [kg]
  double kinetic_scale_per_joule = 1e-3;  ///< weight of kinetic energy against measurements [1/J]
  PerClass<double> force_sigma_mps2 = {1.5, 1.2, 0.8};  ///< typical acceleration [m/s^2]
  double force_standing_ratio = 0.2;  ///< of that acceleration, for a static object [-]
  double force_time_s = 0.3;          ///< correlation time of such an acceleration [s]
  double outlier_sigma = 3.0;         ///< residual from which the Huber loss is linear [-]
  bool gaussian_smoothing = false;    ///< smooth each new position over its predecessors (paper)
  double gaussian_sigma_s = 0.1;      ///< width of that smoothing [s]
  int max_iterations = 10;            ///< of reweighted least squares
  double tolerance_m = 0.001;         ///< change of positions below which it has converged [m]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

/// Confirmation, coasting and deletion of tracks.
///
/// Times of detections are their number times the interval of the frames in which
/// objects are detected.
struct LifecycleParams {
  double confirm_time_s = 0.2;  ///< detections of a confirmed track, at least two [s]
  PerClass<double> confirm_score = {-2.0, 2.0, 2.0};  ///< minimum sum of their scores, at 10 Hz [-]
  double confirm_anyway_time_s = 0.6;  ///< detections that confirm a track of any score [s]
  double start_score = -1.0;           ///< of a detection that starts a track [detector's scale]
  double score_prior_time_s = 0.5;     ///< of score 0 in every track's mean score [s]
  double max_coast_ratio = 1.0;        ///< frames without over frames with detection, if shown [-]
  double max_coast_sigma_m = 0.6;      ///< position uncertainty of a shown, coasting track [m]
  PerClass<double> min_coast_score = {0.1, 0.5, 0.4};  ///< of such a track [detector's scale]
  double tentative_time_s = 0.35;  ///< without detection until a tentative track ends [s]
  double coast_time_s = 0.4;       ///< without detection until a confirmed track is hidden [s]
  double retrack_time_s = 1.5;     ///< without detection until a confirmed track ends [s]

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
  MotionClassParams motion_class;
  SmoothingParams smoothing;
  LifecycleParams lifecycle;

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "objects"); }  ///< @throws InputError
};

}  // namespace headway::objects
