// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the tracker.
#include <headway/objects/objects_params.h>

#include <string>

namespace headway::objects {
namespace {

void addPerClass(Params::Section& section, const std::string& key, PerClass<double>& values,
                 double min, double max, const std::string& unit, const std::string& meaning) {
  section.add("vehicle_" + key, values.vehicle, min, max, unit, meaning);
  section.add("cyclist_" + key, values.cyclist, min, max, unit, meaning);
  section.add("pedestrian_" + key, values.pedestrian, min, max, unit, meaning);
}

void describePriors(SmoothingParams& params, Params::Section& section) {
  addPerClass(section, "kinetic_weight_kg", params.kinetic_weight_kg, 0.0, 1e6, "kg",
              "r: stiffness of the least-kinetic prior");
  section.add("kinetic_scale_per_joule", params.kinetic_scale_per_joule, 0.0, 1e3, "1/J",
              "Weight of kinetic energy relative to the measurements");
  addPerClass(section, "force_sigma_mps2", params.force_sigma_mps2, 0.001, 100.0, "m/s^2",
              "Standard deviation of accelerations in the least-force prior");
  section.add("force_standing_ratio", params.force_standing_ratio, 0.001, 1.0, "",
              "Ratio of that acceleration for a stationary object");
  section.add("force_time_s", params.force_time_s, 0.001, 100.0, "s",
              "Correlation time of such an acceleration");
}

}  // namespace

void ConsistencyParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("min_score", min_score, -1e6, 1e6, "detector's scale",
           "Minimum score of a detection that is used");
  user.add("max_range_m", max_range_m, 1.0, 1e4, "m",
           "Maximum distance of a detection that is used");
  user.add("track_unknown", track_unknown,
           "Track detections of unknown class; false if only known classes matter");
  section.add("gate_sigma", gate_sigma, 0.5, 20.0, "standard deviations",
              "Radius of the gate around a predicted position");
  section.add("new_object_density_per_m2", new_object_density_per_m2, 1e-9, 1e3, "1/m^2",
              "Density of new objects and false alarms, which a match's likelihood must exceed");
  section.add("gate_blur_m", gate_blur_m, 0.0, 10.0, "m",
              "Standard deviation added to every predicted position");
  section.add("max_gate_m", max_gate_m, 0.1, 100.0, "m", "Maximum radius of the gate");
  section.add("duplicate_distance_ratio", duplicate_distance_ratio, 0.0, 2.0, "widths",
              "Distance of centres below which boxes are one object");
  section.add("duplicate_iou_3d", duplicate_iou_3d, 0.0, 1.0, "IoU",
              "Overlap above which 3D boxes are one object");
  section.add("duplicate_iou_2d", duplicate_iou_2d, 0.0, 1.0, "IoU",
              "Overlap above which 2D boxes are one object");
  section.add("duplicate_track_distance_m", duplicate_track_distance_m, 0.0, 10.0, "m",
              "Distance below which tracks of different classes are one object, of which the one "
              "with the highest score is shown");
  section.add("detector_id_bonus", detector_id_bonus, 0.0, 100.0, "",
              "Reduction of a match's cost where the detector's own identity agrees");
}

void FilterParams::describe(Params::Section section) {
  addPerClass(section, "filter_acceleration_mps2", acceleration_sigma_mps2, 0.01, 100.0, "m/s^2",
              "Standard deviation of accelerations in the Kalman filter");
  addPerClass(section, "initial_speed_mps", initial_speed_sigma_mps, 0.01, 100.0, "m/s",
              "Standard deviation of a new object's speed");
  section.add("standing_acceleration_ratio", standing_acceleration_ratio, 0.0, 1.0, "",
              "Ratio of that acceleration for a stationary object");
  section.add("acceleration_time_s", acceleration_time_s, 0.01, 100.0, "s",
              "Correlation time of an acceleration");
  section.add("position_sigma_m", position_sigma_m, 0.001, 10.0, "m",
              "Noise of a measured centre along the ray, at no distance");
  section.add("position_sigma_per_m", position_sigma_per_m, 0.0, 1.0, "m/m",
              "Growth of that noise with depth");
  section.add("across_sigma_ratio", across_sigma_ratio, 0.01, 10.0, "",
              "Ratio of the noise across the ray to that along it");
  section.add("vertical_sigma_m", vertical_sigma_m, 0.001, 10.0, "m", "Noise of a measured z");
  section.add("additional_position_sigma_m", additional_position_sigma_m, 0.0, 10.0, "m",
              "Noise added to the covariance that a detector reports");
  section.add("noise_adaptation", noise_adaptation, 0.0, 1.0, "",
              "Gain by which innovations change the assumed noise; 0 keeps it as configured");
  section.add("yaw_sigma_rad", yaw_sigma_rad, 0.001, 3.0, "rad", "Noise of a measured heading");
  section.add("size_sigma_m", size_sigma_m, 0.001, 10.0, "m",
              "Noise of a measured length, width and height, at no distance");
  section.add("size_converged_ratio", size_converged_ratio, 0.001, 1.0, "",
              "Uncertainty of a size over the noise of a measured one: below, it is not updated");
}

void HeadingParams::describe(Params::Section section) {
  section.add("flip_probability", flip_probability, 0.0001, 0.4999, "",
              "Probability that a detector confuses front and back");
  section.add("flip_log_odds", flip_log_odds, 0.0, 100.0, "log-odds",
              "Evidence from which a track's heading is reversed");
  section.add("max_flip_log_odds", max_flip_log_odds, 0.0, 1000.0, "log-odds",
              "Limit of the accumulated evidence");
  section.add("heading_converged_time_s", converged_time_s, 0.1, 100.0, "s",
              "Time of the measurements after which the heading of a stationary object is fixed");
  section.renamed("heading_converged_frames", "heading_converged_time_s", secondsOfFrames);
}

void MotionClassParams::describe(Params::Section section) {
  addPerClass(section, "moving_speed_mps", moving_speed_mps, 0.0, 50.0, "m/s",
              "Speed above which an object is moving");
  addPerClass(section, "static_speed_mps", static_speed_mps, 0.0, 50.0, "m/s",
              "Speed below which an object may be static");
  section.add("moving_significance", significance, 0.0, 100.0, "standard deviations",
              "Speed over its uncertainty above which an object is moving");
  section.add("static_time_s", static_time_s, 0.0, 100.0, "s",
              "Time below static_speed_mps after which an object is static");
}

void SmoothingParams::describe(Params::Section section) {
  section.user().add("motion_prior", motion_prior,
                     {{"least_kinetic", MotionPriorKind::kLeastKinetic},
                      {"least_force", MotionPriorKind::kLeastForce}},
                     "Prior that smooths trajectories: the paper's least_kinetic lags behind "
                     "moving objects, least_force does not");
  section.add("mature_time_s", mature_time_s, 0.0, 100.0, "s",
              "tau_KF: time of a track's detections from which the motion prior smooths it");
  section.renamed("mature_frames", "mature_time_s", secondsOfFrames);
  section.add("filter_weight", filter_weight, 0.0, 1.0, "",
              "w_k: weight of the filter for shorter tracks");
  section.add("average_weight", average_weight, 0.0, 1.0, "",
              "w_n: weight of the moving average for shorter tracks");
  section.add("average_time_s", average_time_s, 0.0, 10.0, "s", "n of the moving average");
  section.renamed("average_frames", "average_time_s", secondsOfFrames);
  section.add("window_s", window_s, 0.3, 20.0, "s",
              "h: time of the detections that the motion prior smooths");
  section.renamed("window_frames", "window_s", secondsOfFrames);
  describePriors(*this, section);
  section.add("outlier_sigma", outlier_sigma, 0.1, 1000.0, "standard deviations",
              "Residual beyond which a measured position is down-weighted (Huber)");
  section.add("gaussian_smoothing", gaussian_smoothing,
              "Smooth each new position with its predecessors, as in the paper");
  section.add("gaussian_sigma_s", gaussian_sigma_s, 0.001, 10.0, "s", "Width of that smoothing");
  section.add("max_smoother_iterations", max_iterations, 1, 1000, "",
              "Maximum iterations of reweighted least squares");
  section.add("smoother_tolerance_m", tolerance_m, 1e-12, 1.0, "m",
              "Change of positions below which they have converged");
}

void LifecycleParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("confirm_time_s", confirm_time_s, 0.0, 100.0, "s",
           "Minimum time of the detections of a confirmed track, of which there are at least two; "
           "greater for a detector with false alarms");
  user.renamed("confirm_hits", "confirm_time_s", secondsOfFrames);
  user.add("coast_time_s", coast_time_s, 0.0, 100.0, "s",
           "Time without detection for which a confirmed track is shown; greater for a slow "
           "detector");
  section.add("retrack_time_s", retrack_time_s, 0.0, 100.0, "s",
              "Time without detection after which a track ends");
  addPerClass(section, "confirm_score", confirm_score, -1e6, 1e6, "detector's scale",
              "Minimum sum of a confirmed track's scores, at 10 detections a second");
  section.add("confirm_anyway_time_s", confirm_anyway_time_s, 0.0, 100.0, "s",
              "Time of the detections that confirm a track regardless of the sum of their scores");
  section.renamed("confirm_anyway_hits", "confirm_anyway_time_s", secondsOfFrames);
  section.add("start_score", start_score, -1e6, 1e6, "detector's scale",
              "Minimum score of a detection that starts a track");
  section.add("score_prior_time_s", score_prior_time_s, 0.0, 100.0, "s",
              "Time of score 0 in every track's mean score, which lowers that of short tracks");
  section.renamed("score_prior_frames", "score_prior_time_s", secondsOfFrames);
  section.add("max_coast_ratio", max_coast_ratio, 0.0, 1000.0, "",
              "Maximum ratio of frames without to frames with detection of a shown track");
  section.add("max_coast_sigma_m", max_coast_sigma_m, 0.0, 100.0, "m",
              "Maximum position uncertainty of a track shown without detection");
  addPerClass(section, "min_coast_score", min_coast_score, -1e6, 1e6, "detector's scale",
              "Minimum score of a track shown without detection");
  section.add("tentative_time_s", tentative_time_s, 0.0, 100.0, "s",
              "Time without detection after which a tentative track ends");
}

void ObjectsParams::describe(Params::Section section) {
  section.user().add(
      "predictor", predictor,
      {{"paper", PredictorKind::kPaper},
       {"paper_dm", PredictorKind::kPaperDm},
       {"paper_hd", PredictorKind::kPaperHd},
       {"paper_sv", PredictorKind::kPaperSv},
       {"polynomial", PredictorKind::kPolynomial},
       {"constant_velocity", PredictorKind::kConstantVelocity},
       {"constant_turn", PredictorKind::kConstantTurn},
       {"mixture", PredictorKind::kMixture}},
      "Predictor of the next 3 s; mixture is the most accurate, the others are for comparison");
  consistency.describe(section);
  filter.describe(section);
  heading.describe(section);
  motion_class.describe(section);
  smoothing.describe(section);
  lifecycle.describe(section);
  prediction.describe(section);
}

}  // namespace headway::objects
