#include <headway/detect/stereo_motion.h>

namespace headway::detect {

void StereoMotionParams::describe(Params::Section section) {
  section.add("max_points", max_points, 100, 10000, "", "Points followed at a time");
  section.add("spacing_px", spacing_px, 4, 64, "px", "Between points");
  section.add("window_s", window_s, 0.1, 3.0, "s", "How far back a point's sightings count");
  section.add("body_window_s", body_window_s, 0.1, 3.0, "s",
              "How far back the sightings of a body's parts count");
  section.add("range_m", range_m, 2.0, 200.0, "m", "Farther points are not followed");
  section.add("least_height_m", least_height_m, 0.0, 5.0, "m",
              "Above ground, of points on objects");
  section.add("most_height_m", most_height_m, 0.5, 20.0, "m", "Above ground, of points on objects");
  section.add("sigma_px", sigma_px, 0.05, 5.0, "px", "Error of a point's place in an image");
  section.add("sigma_disparity_px", sigma_disparity_px, 0.05, 5.0, "px",
              "Error of a point's disparity");
  section.add("significance", significance, 5.0, 1000.0, "-",
              "Of a point's motion against standing still, chi-square of 3 degrees of freedom");
  section.add("least_speed", least_speed, 0.05, 20.0, "m/s", "Slower objects stand still");
  section.add("most_speed", most_speed, 1.0, 200.0, "m/s", "Nothing is faster");
  section.add("least_points", least_points, 2, 50, "", "Points that make an object");
  section.add("confirm_frames", confirm_frames, 1, 10, "frames",
              "In which an object must have been found before it is reported");
  section.add("reach_m", reach_m, 0.1, 10.0, "m", "Between points of one object, over the ground");
  section.add("moving_share", moving_share, 0.0, 1.0, "-",
              "Of the points inside an object's outline that must move");
  section.add("blob_range_m", blob_range_m, 2.0, 100.0, "m",
              "Farther things of a person's size are not followed as a whole");
  section.add("body_significance", body_significance, 5.0, 1000.0, "-",
              "Of a body's motion against standing still, chi-square of 2 degrees of freedom");
  section.add("most_moving", most_moving, 0.1, 1.0, "-",
              "If more of all points seem to move, the camera's motion is taken for wrong");
  section.add("guess_class", guess_class,
              "Guess classes from size and speed; else every object is Unknown");
}

}  // namespace headway::detect
