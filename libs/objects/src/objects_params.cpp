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

}  // namespace

void ConsistencyParams::describe(Params::Section section) {
  section.add("min_score", min_score, -1e6, 1e6, "detector's scale",
              "Detections with a lower score are left out");
  section.add("max_range", max_range_m, 1.0, 1e4, "m", "Detections farther away are left out");
  section.add("track_unknown", track_unknown, "Track detections of unknown class too");
  section.add("gate_sigma", gate_sigma, 0.5, 20.0, "standard deviations",
              "Radius of the gate around a predicted place");
  section.add("new_object_density", new_object_density, 1e-9, 1e3, "1/m^2",
              "New objects and false alarms that a place holds: what a match must beat");
  section.add("gate_blur", gate_blur_m, 0.0, 10.0, "m",
              "Added to the spread of every expected place");
  section.add("gate_max", gate_max_m, 0.1, 100.0, "m", "Largest radius of the gate");
  section.add("duplicate_distance", duplicate_distance, 0.0, 2.0, "widths",
              "Boxes whose centres are nearer are one object");
  section.add("duplicate_overlap_3d", duplicate_overlap_3d, 0.0, 1.0, "IoU",
              "3D boxes that overlap more are one object");
  section.add("duplicate_overlap_2d", duplicate_overlap_2d, 0.0, 1.0, "IoU",
              "2D boxes that overlap more are one object");
  section.add("rival_distance", rival_distance_m, 0.0, 10.0, "m",
              "Tracks of different kinds nearer than this are one object: the surest is shown");
  section.add("hint_bonus", hint_bonus, 0.0, 100.0, "",
              "Taken off the cost of a match where the detector's own id agrees");
}

void FilterParams::describe(Params::Section section) {
  addPerClass(section, "filter_acceleration", acceleration_sigma, 0.01, 100.0, "m/s^2",
              "Typical acceleration, as the filter expects it");
  addPerClass(section, "initial_speed", initial_speed_sigma, 0.01, 100.0, "m/s",
              "Typical speed of a new object");
  section.add("standing_share", standing_share, 0.0, 1.0, "",
              "Share of that acceleration that an object which stands may show");
  section.add("acceleration_time", acceleration_time_s, 0.01, 100.0, "s",
              "Time over which an acceleration lasts");
  section.add("position_sigma", position_sigma_m, 0.001, 10.0, "m",
              "Noise of a measured centre along the ray, of near objects");
  section.add("position_sigma_per_m", position_sigma_per_m, 0.0, 1.0, "m/m",
              "Growth of that noise with depth");
  section.add("across_share", across_share, 0.01, 10.0, "",
              "Noise across the ray, as a share of that along it");
  section.add("vertical_sigma", vertical_sigma_m, 0.001, 10.0, "m", "Noise of a measured z");
  section.add("least_position_sigma", least_position_sigma_m, 0.0, 10.0, "m",
              "Added to the noise that a detector claims for itself");
  section.add(
      "noise_adaption", noise_adaption, 0.0, 1.0, "",
      "Share of a surprise by which the assumed noise is changed; 0 keeps it as configured");
  section.add("yaw_sigma", yaw_sigma_rad, 0.001, 3.0, "rad", "Noise of a measured heading");
  section.add("size_sigma", size_sigma_m, 0.001, 10.0, "m",
              "Noise of a measured length, width and height");
  section.add("size_settled", size_settled_m, 0.001, 10.0, "m",
              "A size known this well is kept from then on");
}

void HeadingParams::describe(Params::Section section) {
  section.add("flip_probability", flip_probability, 0.0001, 0.4999, "",
              "Probability that a detector confuses front and back");
  section.add("flip_evidence", evidence_to_turn, 0.0, 100.0, "log-odds",
              "Evidence that turns a track's heading round");
  section.add("flip_evidence_limit", evidence_limit, 0.0, 1000.0, "log-odds",
              "Evidence beyond this is not gathered");
  section.add("heading_settle_frames", settle_frames, 1.0, 1000.0, "frames",
              "Measurements that fix the heading of a standing object");
}

void MotionVerdictParams::describe(Params::Section section) {
  addPerClass(section, "moving_speed", moving_speed, 0.0, 50.0, "m/s",
              "An object faster than this moves");
  addPerClass(section, "still_speed", still_speed, 0.0, 50.0, "m/s",
              "An object slower than this may stand");
  section.add("moving_significance", significance, 0.0, 100.0, "standard deviations",
              "A speed must be this sure before an object counts as moving");
  section.add("still_time", still_time_s, 0.0, 100.0, "s",
              "Time below still_speed after which an object stands");
}

void SmoothingParams::describe(Params::Section section) {
  section.add("motion_prior", motion_prior,
              {{"least_kinetic", MotionPriorKind::kLeastKinetic},
               {"least_force", MotionPriorKind::kLeastForce}},
              "Prior that smooths grown tracks");
  section.add("grown_length", grown_length, 2, 1000, "frames",
              "tau_KF: tracks at least this long are grown");
  section.add("filter_weight", filter_weight, 0.0, 1.0, "",
              "w_k: weight of the filter for young tracks");
  section.add("average_weight", average_weight, 0.0, 1.0, "",
              "w_n: weight of the moving average for young tracks");
  section.add("average_points", average_points, 1, 100, "frames", "n of the moving average");
  section.add("window", window, 3, 200, "frames", "h: frames that the motion prior smooths");
  addPerClass(section, "kinetic_weight", kinetic_weight, 0.0, 1e6, "kg",
              "r: stiffness of the least-kinetic prior");
  section.add("kinetic_scale", kinetic_scale, 0.0, 1e3, "1/J",
              "Turns kinetic energy into a cost beside that of the measurements");
  addPerClass(section, "force_sigma", force_sigma, 0.001, 100.0, "m/s^2",
              "Typical acceleration, as the least-force prior expects it");
  section.add("force_standing_share", force_standing_share, 0.001, 1.0, "",
              "Share of that acceleration that an object which stands may show");
  section.add("force_time", force_time_s, 0.001, 100.0, "s",
              "Time over which such an acceleration lasts");
  section.add("outlier_sigma", outlier_sigma, 0.1, 1000.0, "standard deviations",
              "Residual beyond which a measured place counts less");
  section.add("gaussian_smoothing", gaussian_smoothing,
              "Blur each new place over its predecessors, as the paper does");
  section.add("gaussian_sigma", gaussian_sigma_s, 0.001, 10.0, "s", "Width of that blur");
  section.add("smoother_iterations", max_iterations, 1, 1000, "",
              "Most iterations of Levenberg-Marquardt");
  section.add("smoother_settled", settled_m, 1e-12, 1.0, "m",
              "Levenberg-Marquardt ends when no place moves farther");
}

void LifecycleParams::describe(Params::Section section) {
  section.add("confirm_hits", confirm_hits, 1, 1000, "frames",
              "Detections that a confirmed track must have had");
  addPerClass(section, "confirm_score", confirm_score, -1e6, 1e6, "detector's scale",
              "What their scores must add up to");
  section.add("confirm_anyway_hits", confirm_anyway_hits, 1, 1000, "frames",
              "Detections that confirm a track whatever their scores add up to");
  section.add("start_score", start_score, -1e6, 1e6, "detector's scale",
              "Detections with a lower score continue tracks but start none");
  section.add("score_prior", score_prior, 0.0, 1000.0, "frames",
              "Frames of score 0 that every track's score starts with: short tracks are less sure");
  section.add("coast_share", coast_share, 0.0, 1000.0, "",
              "A track is shown unseen for at most this share of the frames it was seen in");
  section.add("coast_sigma", coast_sigma_m, 0.0, 100.0, "m",
              "A track is shown unseen only while its place is known this well");
  addPerClass(section, "coast_score", coast_score, -1e6, 1e6, "detector's scale",
              "A track is shown unseen only if its score is at least this");
  section.add("tentative_time", tentative_time_s, 0.0, 100.0, "s",
              "A tentative track unseen for longer ends");
  section.add("coast_time", coast_time_s, 0.0, 100.0, "s",
              "A confirmed track unseen for longer is no longer shown");
  section.add("retrack_time", retrack_time_s, 0.0, 100.0, "s",
              "A track unseen for longer is not taken up again");
}

void ObjectsParams::describe(Params::Section section) {
  section.add("predictor", predictor,
              {{"paper", PredictorKind::kPaper},
               {"paper_dm", PredictorKind::kPaperDm},
               {"paper_hd", PredictorKind::kPaperHd},
               {"paper_sv", PredictorKind::kPaperSv},
               {"polynomial", PredictorKind::kPolynomial},
               {"constant_velocity", PredictorKind::kConstantVelocity},
               {"constant_turn", PredictorKind::kConstantTurn},
               {"mixture", PredictorKind::kMixture}},
              "Predictor of the next 3 s");
  consistency.describe(section);
  filter.describe(section);
  heading.describe(section);
  verdict.describe(section);
  smoothing.describe(section);
  lifecycle.describe(section);
  prediction.describe(section);
}

}  // namespace headway::objects
