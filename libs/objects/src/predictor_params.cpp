#include <headway/objects/predictor_params.h>

namespace headway::objects {

void PaperPredictorParams::describe(Params::Section section) {
  section.add("paper_tangent_weight", tangent_weight, 0.0, 1.0, "",
              "Weight w1 of the path's direction in the head direction V_h");
  section.add("paper_heading_weight", heading_weight, 0.0, 1.0, "",
              "Weight w2 of the detected heading in the head direction V_h");
  section.add("paper_heading_limit", heading_limit_rad, 0.0, 3.15, "rad",
              "tau_theta: a detected heading farther from the path's direction is left out");
  section.add("paper_straight_limit", straight_limit_rad, 0.0, 3.15, "rad",
              "tau_alpha: below this angle between V_h and V_p the path counts as straight");
  section.add("paper_recent_weight", recent_weight, -10.0, 10.0, "",
              "Weight w3 of the recent direction in the prediction direction V_p");
  section.add("paper_older_weight", older_weight, -10.0, 10.0, "",
              "Weight w4 of the older direction in the prediction direction V_p");
  section.add("paper_spacing", spacing_s, 0.05, 10.0, "s",
              "Time between the three places that give V_p");
  section.add("paper_speed_samples", speed_samples, 1, 200, "frames",
              "h: steps over which the speed is averaged, eq. (1)");
  section.add("paper_speed_factor", speed_factor, 0.1, 10.0, "", "gamma of eq. (1)");
  section.add("paper_epsilon", epsilon_s, 0.0, 0.1, "s", "epsilon of eq. (1)");
}

void ManoeuvreParams::describe(Params::Section section, const std::string& prefix) {
  section.add(prefix + "memory", memory_s, 0.1, 100.0, "s",
              "Age at which a place says nothing of the present motion");
  section.add(prefix + "path_noise", path_noise_m, 0.001, 10.0, "m",
              "By which even exactly known paths leave a parabola");
  section.add(prefix + "typical_speed", typical_speed, 0.01, 1000.0, "m/s",
              "Typical speed, for paths too short to tell");
  section.add(prefix + "typical_acceleration", typical_acceleration, 1e-3, 100.0, "m/s^2",
              "Typical acceleration along the path");
  section.add(prefix + "typical_turn", typical_turn, 1e-3, 100.0, "m/s^2",
              "Typical acceleration across the path");
  section.add(prefix + "acceleration_fade", acceleration_fade_s, 0.05, 1000.0, "s",
              "Time in which an acceleration fades");
  section.add(prefix + "turn_fade", turn_fade_s, 0.05, 1000.0, "s", "Time in which a turn fades");
  section.add(prefix + "standing_speed", standing_speed, 0.001, 10.0, "m/s",
              "Slower motion may be noise of a standing object");
  section.add(prefix + "cruising_speed", cruising_speed, 0.001, 50.0, "m/s",
              "An object that is faster manoeuvres freely");
  section.add(prefix + "other_acceleration", other_acceleration, 0.0, 20.0, "m/s^2",
              "By which the slower and the faster alternative differ");
  section.add(prefix + "acceleration_sigma", acceleration_sigma, 0.0, 20.0, "m/s^2",
              "Unforeseen acceleration along the path");
  section.add(prefix + "lateral_sigma", lateral_sigma, 0.0, 20.0, "m/s^2",
              "Unforeseen acceleration across the path");
}

void PredictorParams::describe(Params::Section section) {
  paper.describe(section);
  section.add("velocity_window", velocity_window_s, 0.05, 5.0, "s",
              "Time over which constant_velocity and constant_turn read the velocity");
  manoeuvres.vehicle.describe(section, "vehicle_");
  manoeuvres.cyclist.describe(section, "cyclist_");
  manoeuvres.pedestrian.describe(section, "pedestrian_");
}

}  // namespace headway::objects
