// SPDX-License-Identifier: BSD-3-Clause
#include <headway/objects/predictor_params.h>

namespace headway::objects {

void PaperPredictorParams::describe(Params::Section section) {
  section.add("paper_tangent_weight", tangent_weight, 0.0, 1.0, "",
              "w1: weight of the path's direction in the head direction V_h");
  section.add("paper_heading_weight", heading_weight, 0.0, 1.0, "",
              "w2: weight of the detected heading in the head direction V_h");
  section.add("paper_heading_limit_rad", heading_limit_rad, 0.0, 3.15, "rad",
              "tau_theta: maximum angle of a detected heading to the path's direction");
  section.add("paper_straight_limit_rad", straight_limit_rad, 0.0, 3.15, "rad",
              "tau_alpha: angle between V_h and V_p below which the path is straight");
  section.add("paper_recent_weight", recent_weight, -10.0, 10.0, "",
              "w3: weight of the recent direction in the prediction direction V_p");
  section.add("paper_older_weight", older_weight, -10.0, 10.0, "",
              "w4: weight of the older direction in the prediction direction V_p");
  section.add("paper_spacing_s", spacing_s, 0.05, 10.0, "s",
              "Time between the three positions that give V_p");
  section.add("paper_speed_samples", speed_samples, 1, 200, "frames",
              "h: steps over which the speed is averaged, eq. (1)");
  section.add("paper_speed_factor", speed_factor, 0.1, 10.0, "", "gamma of eq. (1)");
  section.add("paper_epsilon_s", epsilon_s, 0.0, 0.1, "s", "epsilon of eq. (1)");
}

void ManoeuvreParams::describe(Params::Section section, const std::string& prefix) {
  section.add(prefix + "memory_s", memory_s, 0.1, 100.0, "s",
              "Age beyond which positions have no weight in the fit of the motion");
  section.add(prefix + "path_noise_m", path_noise_m, 0.001, 10.0, "m",
              "Deviation of exactly known paths from a parabola");
  section.add(prefix + "typical_speed_mps", typical_speed_mps, 0.01, 1000.0, "m/s",
              "Prior of the speed, for short paths");
  section.add(prefix + "typical_acceleration_mps2", typical_acceleration_mps2, 1e-3, 100.0, "m/s^2",
              "Prior of the acceleration along the path");
  section.add(prefix + "typical_lateral_mps2", typical_lateral_mps2, 1e-3, 100.0, "m/s^2",
              "Prior of the acceleration across the path");
  section.add(prefix + "acceleration_fade_s", acceleration_fade_s, 0.05, 1000.0, "s",
              "Decay time of an acceleration");
  section.add(prefix + "turn_fade_s", turn_fade_s, 0.05, 1000.0, "s", "Decay time of a turn");
  section.add(prefix + "standing_speed_mps", standing_speed_mps, 0.001, 10.0, "m/s",
              "Speed below which motion may be noise of a stationary object");
  section.add(prefix + "setting_off_mps", setting_off_mps, 0.0, 10.0, "m/s",
              "Unpredicted velocity of a stationary object, which may set off");
  section.add(prefix + "cruising_speed_mps", cruising_speed_mps, 0.001, 50.0, "m/s",
              "Speed above which an object manoeuvres freely");
  section.add(prefix + "alternative_mps2", alternative_mps2, 0.0, 20.0, "m/s^2",
              "Acceleration of the faster and of the slower alternative");
  section.add(prefix + "acceleration_sigma_mps2", acceleration_sigma_mps2, 0.0, 20.0, "m/s^2",
              "Unpredicted acceleration along the path");
  section.add(prefix + "lateral_sigma_mps2", lateral_sigma_mps2, 0.0, 20.0, "m/s^2",
              "Unpredicted acceleration across the path");
}

void PredictorParams::describe(Params::Section section) {
  paper.describe(section);
  section.add("velocity_window_s", velocity_window_s, 0.05, 5.0, "s",
              "Time over which constant_velocity and constant_turn estimate the velocity");
  manoeuvres.vehicle.describe(section, "vehicle_");
  manoeuvres.cyclist.describe(section, "cyclist_");
  manoeuvres.pedestrian.describe(section, "pedestrian_");
}

}  // namespace headway::objects
