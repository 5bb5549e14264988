// SPDX-License-Identifier: BSD-3-Clause
// Everything that a world's .ini says.
#include <headway/core/error.h>
#include <headway/sim/sim_params.h>

#include <algorithm>

namespace headway::sim {

void RouteParams::describe(Params::Section section) {
  section.add("kind", kind,
              {{"lane", Kind::kLane}, {"loop", Kind::kLoop}, {"kitti_poses", Kind::kKittiPoses}},
              "Where the path comes from");
  section.add(
      "shape", shape,
      "Path of kind lane: 'straight METRES', 'left RADIUS DEGREES', 'right RADIUS DEGREES', "
      "separated by commas");
  section.add("loop_length_m", loop_length_m, 40.0, 5000.0, "m", "Long side of the loop");
  section.add("loop_width_m", loop_width_m, 40.0, 5000.0, "m", "Short side of the loop");
  section.add("corner_radius_m", corner_radius_m, 8.0, 500.0, "m", "Corners of the loop");
  section.add("laps", laps, 1, 100, "", "Times around the loop");
  section.add("file", file, "Path of kind kitti_poses: 3x4 camera poses, one a row");
  section.add("speed_mps", speed_mps, 0.2, 40.0, "m/s", "Robot's speed on a free, straight street");
  section.add("lateral_acceleration_mps2", lateral_acceleration_mps2, 0.2, 8.0, "m/s^2",
              "The robot slows down for curves to stay below this");
}

void WorldParams::describe(Params::Section section) {
  section.add("kind", kind,
              {{"street", Kind::kStreet},
               {"hall", Kind::kHall},
               {"campus", Kind::kCampus},
               {"warehouse", Kind::kWarehouse}},
              "Streets of a town, or a place for robots; hall, campus and warehouse use no other "
              "key of [route] than speed_mps");
  section.add("seed", seed, 0, 1000000000, "", "Another seed, another world");
  section.add("view_distance_m", view_distance_m, 30.0, 280.0, "m", "Nothing farther is drawn");
  section.add("cross_street_every_m", cross_street_every_m, 0.0, 10000.0, "m",
              "Distance between junctions; 0: none");
  section.add("house_ratio", house_ratio, 0.0, 1.0, "", "Ratio of the frontage with houses");
  section.add("house_height_min_m", house_height_min_m, 3.0, 60.0, "m", "Lowest house");
  section.add("house_height_max_m", house_height_max_m, 3.0, 60.0, "m", "Highest house");
  section.add("tree_every_m", tree_every_m, 0.0, 1000.0, "m", "Trees along each side; 0: none");
  section.add("parked_ratio", parked_ratio, 0.0, 1.0, "", "Ratio of the parking bays taken");
  section.add("hill_height_m", hill_height_m, 0.0, 20.0, "m", "Rise and fall of the ground");
  section.add("fence_ratio", fence_ratio, 0.0, 1.0, "",
              "Ratio of a street's frontage with picket fences or railings");
  section.add("moved_ratio", moved_ratio, 0.0, 1.0, "",
              "Ratio of the furniture and loads of hall, campus or warehouse that are otherwise "
              "than the seed places them");
  section.add("machines", machines, 0, 200, "",
              "Machines and furniture of random shapes beside the walls of hall, campus or "
              "warehouse");
  section.add("identical_racks", identical_racks,
              "All bays of a warehouse's racks are loaded like the first");
}

void TrafficParams::describe(Params::Section section) {
  section.add("vehicles", vehicles, 0, 200, "", "Driving cars, vans, trucks, buses near the robot");
  section.add("cyclists", cyclists, 0, 100, "", "Cyclists near the robot");
  section.add("pedestrians", pedestrians, 0, 400, "", "Pedestrians near the robot");
  section.add("van_ratio", van_ratio, 0.0, 1.0, "", "Of the vehicles");
  section.add("truck_ratio", truck_ratio, 0.0, 1.0, "", "Of the vehicles");
  section.add("bus_ratio", bus_ratio, 0.0, 1.0, "", "Of the vehicles");
  section.add("oncoming_ratio", oncoming_ratio, 0.0, 1.0, "", "Of the vehicles on the street");
  section.add("crossing_ratio", crossing_ratio, 0.0, 1.0, "",
              "Of the vehicles, those that come out of cross streets");
  section.add("turning_ratio", turning_ratio, 0.0, 1.0, "",
              "Of the vehicles on the street, those that turn off");
  section.add("vehicle_speed_mps", vehicle_speed_mps, 1.0, 40.0, "m/s", "Mean preferred speed");
  section.add("walking_speed_mps", walking_speed_mps, 0.3, 3.0, "m/s", "Mean preferred speed");
  section.add("road_crossing_rate_hz", road_crossing_rate_hz, 0.0, 1.0, "1/s",
              "Rate at which a pedestrian crosses the street");
  section.add("group_ratio", group_ratio, 0.0, 1.0, "", "Of the pedestrians, those in groups");
  section.add("stop_rate_hz", stop_rate_hz, 0.0, 1.0, "1/s", "Rate at which a pedestrian stops");
  section.add("in_front_at_start", in_front_at_start, 0, 60, "",
              "Moving objects close before the camera at the start");
  section.add("image_share", image_share, 0.0, 0.6, "",
              "Mean ratio of the left image that moving objects cover, from the first frame on: "
              "a few vehicles stay close to the robot, instead of the others; 0: no control");
  section.add("cover", cover, 0.0, 0.8, "",
              "Ratio of the view that people who walk before the camera cover in hall, campus or "
              "warehouse");
  section.add("idle_people", idle_people, 0, 100, "",
              "People who sit or stand about in hall, campus or warehouse");
  section.add("varied_bodies", varied_bodies,
              "People in hall, campus or warehouse are 1.1 to 2.0 m high, slim or broad, bent, "
              "carry, push, or sit in wheelchairs");
  section.add("encounter_ratio", encounter_ratio, 0.0, 1.0, "",
              "Of the walkers' ways in hall, campus or warehouse, those that meet the robot");
  section.add("range_ahead_m", range_ahead_m, 20.0, 250.0, "m",
              "Distance ahead of the robot within which objects move");
  section.add("range_behind_m", range_behind_m, 5.0, 100.0, "m",
              "Distance behind the robot within which objects move");
}

void RobotParams::describe(Params::Section section) {
  section.add("standing", standing, "The robot never moves");
  section.add(
      "tour_stops", tour_stops, 0, 20, "",
      "Stops of a tour in hall, campus or warehouse that ends at its start and is repeated; "
      "0: from stop to stop at random");
  section.add("turn_rate_dps", turn_rate_dps, 10.0, 180.0, "deg/s", "Maximum, on the spot");
  section.add("acceleration_mps2", acceleration_mps2, 0.1, 5.0, "m/s^2", "At the start");
  section.add("brake_mps2", brake_mps2, 0.3, 8.0, "m/s^2", "Hard braking");
  section.add("sudden_stop_rate_hz", sudden_stop_rate_hz, 0.0, 1.0, "1/s",
              "Rate at which the robot brakes hard without cause");
}

void LaserParams::describe(Params::Section section) {
  section.add("enabled", enabled, "Record a 2D laser scanner, one scan with each stereo frame");
  section.add("aperture_deg", aperture_deg, 10.0, 360.0, "deg", "About the forward axis");
  section.add("rays", rays, 10, 5000, "", "Of a scan");
  section.add("min_range_m", min_range_m, 0.0, 5.0, "m", "Nothing nearer is measured");
  section.add("max_range_m", max_range_m, 1.0, 100.0, "m", "Nothing farther is measured");
  section.add("sigma_m", sigma_m, 0.0, 1.0, "m", "Noise of a range, standard deviation");
  section.add("miss_ratio", miss_ratio, 0.0, 1.0, "", "Of the rays, without return");
  section.add("height_m", height_m, 0.03, 3.0, "m", "Above the ground");
  section.add("forward_m", forward_m, -5.0, 5.0, "m", "Before the robot's origin");
}

void GnssParams::describe(Params::Section section) {
  section.add("enabled", enabled, "Record a satellite receiver");
  section.add("rate_hz", rate_hz, 0.1, 20.0, "Hz", "Fixes a second");
  section.add("sigma_m", sigma_m, 0.0, 50.0, "m", "Noise of each horizontal axis");
  section.add("outlier_ratio", outlier_ratio, 0.0, 0.9, "", "Ratio of the fixes that are wrong");
  section.add("outlier_m", outlier_m, 0.0, 1000.0, "m", "Wrong fixes are displaced by up to this");
  section.add("forward_m", forward_m, -5.0, 5.0, "m", "Antenna before the robot's origin");
  section.add("height_m", height_m, -5.0, 5.0, "m", "Antenna above the robot's origin");
  section.add("latitude_deg", latitude_deg, -85.0, 85.0, "deg", "Of the world's origin");
  section.add("longitude_deg", longitude_deg, -180.0, 180.0, "deg", "Of the world's origin");
  section.add("altitude_m", altitude_m, -400.0, 9000.0, "m", "Of the world's origin");
  section.add("heading_deg", heading_deg, -360.0, 360.0, "deg",
              "Direction of the world's x axis, clockwise from north");
}

void CameraParams::describe(Params::Section section) {
  section.add("width", width, 64, 4096, "px", "Image width");
  section.add("height", height, 64, 4096, "px", "Image height");
  section.add("focal_px", focal_px, 50.0, 10000.0, "px", "Focal length");
  section.add("baseline_m", baseline_m, 0.01, 2.0, "m", "Distance of the two cameras");
  section.add("mount_height_m", mount_height_m, 0.2, 4.0, "m", "Cameras above the ground");
  section.add("mount_forward_m", mount_forward_m, -5.0, 5.0, "m", "Cameras before the origin");
  section.add("pitch_down_deg", pitch_down_deg, -45.0, 60.0, "deg",
              "Optical axes below the horizontal");
  section.add("rate_hz", rate_hz, 0.5, 100.0, "Hz", "Pairs a second");
  section.add("ride_deg", ride_deg, 0.0, 5.0, "deg", "Pitching and rolling of the robot");
  section.add("noise_grey", noise_grey, 0.0, 30.0, "grey levels", "Sensor noise");
  section.add("gain_difference", gain_difference, -0.5, 0.5, "", "Right image brighter by this");
  section.add("vignetting", vignetting, 0.0, 0.9, "", "Loss of light in the corners");
  section.add("exposure_change", exposure_change, 0.0, 0.8, "", "Slow change of brightness");
  section.add("gamma", gamma, 0.2, 5.0, "",
              "Exponent of the brightness; below 1 the picture is brighter, above darker");
  section.add("blur_samples", blur_samples, 1, 16, "", "Drawings averaged for motion blur");
  section.add("exposure_s", exposure_s, 0.0, 0.1, "s", "Exposure time (motion blur)");
  section.add("k1", k1, -0.5, 0.5, "", "Radial distortion; non-zero: raw images");
  section.add("k2", k2, -0.5, 0.5, "", "Radial distortion, fourth order");
  section.add("drop_ratio", drop_ratio, 0.0, 0.9, "", "Frames lost");
  section.add("jitter_s", jitter_s, 0.0, 0.05, "s", "Irregularity of the frames' times");
  section.add("odometry", odometry, "Record wheel odometry");
  section.add("wheel_slip_ratio", wheel_slip_ratio, 0.0, 1.0, "",
              "Ratio of the time in which the wheels turn twice as fast as the robot moves");
  section.add("imu", imu, "Record an inertial sensor at 100 Hz");
  section.add("colour", colour, "Colour images; false: grey");
  section.add("depth_camera", depth_camera,
              "Record images with depth instead of pairs; baseline_m is the projector's distance");
  section.add("depth_noise", depth_noise, 0.0, 0.1, "1/m", "Noise of a depth by its square");
  section.add("depth_min_m", depth_min_m, 0.05, 10.0, "m", "Nearest depth measured");
  section.add("depth_max_m", depth_max_m, 0.5, 60.0, "m", "Farthest depth measured");
}

void CalibrationErrorParams::describe(Params::Section section) {
  section.add("focal_ratio", focal_ratio, -0.05, 0.05, "", "True focal length above the recorded");
  section.add("baseline_ratio", baseline_ratio, -0.05, 0.05, "",
              "True baseline above the recorded");
  section.add("right_roll_deg", right_roll_deg, -2.0, 2.0, "deg",
              "Right camera turned about its viewing direction");
  section.add("right_pitch_deg", right_pitch_deg, -2.0, 2.0, "deg", "Right camera turned up");
  section.add("right_yaw_deg", right_yaw_deg, -2.0, 2.0, "deg", "Right camera turned to its right");
  section.add("flex_deg", flex_deg, 0.0, 0.5, "deg",
              "The rig bends from frame to frame: standard deviation about each axis");
}

void DetectorParams::describe(Params::Section section) {
  section.add("max_range_m", max_range_m, 1.0, 300.0, "m", "Nothing farther is detected");
  section.add("min_height_px", min_height_px, 0.0, 1000.0, "px", "Nothing lower is detected");
  section.add("position_sigma_m", position_sigma_m, 0.0, 10.0, "m",
              "Noise across the ray at 20 m, grows with depth");
  section.add("depth_sigma_m", depth_sigma_m, 0.0, 10.0, "m",
              "Noise along the ray at 20 m, grows with depth");
  section.add("size_sigma", size_sigma, 0.0, 0.5, "", "Noise of the size, relative to it");
  section.add("yaw_sigma_rad", yaw_sigma_rad, 0.0, 3.0, "rad", "Noise of the heading");
  section.add("box_sigma_px", box_sigma_px, 0.0, 50.0, "px", "Noise of the 2D edges");
  section.add("miss_near", miss_near, 0.0, 1.0, "", "Missed when near and in full view");
  section.add("miss_far", miss_far, 0.0, 1.0, "", "Missed at max_range_m");
  section.add("miss_occluded", miss_occluded, 0.0, 1.0, "", "Missed when hardly visible");
  section.add("duplicate_probability", duplicate_probability, 0.0, 1.0, "",
              "Probability that a box is detected twice");
  section.add("false_per_frame", false_per_frame, 0.0, 100.0, "", "Boxes without an object");
  section.add("flip_probability", flip_probability, 0.0, 1.0, "",
              "Probability that a heading is turned by 180 degrees");
  section.add("id_switch_probability", id_switch_probability, 0.0, 1.0, "",
              "Probability that an id changes in a frame");
  section.add("boxes_2d", boxes_2d, "Give 2D boxes");
  section.add("boxes_3d", boxes_3d, "Give 3D boxes");
  section.add("parked", parked, "Detect parked vehicles, too");
}

void RecordingParams::describe(Params::Section section) {
  section.add("frames", frames, 1, 1000000, "", "Stereo frames (fewer if the path ends)");
  section.add("first_frame", first_frame, 0, 1000000, "",
              "Frames before this one pass undrawn: for a piece out of the middle");
  section.add("start_time_s", start_time_s, 0.0, 4e9, "s", "Time of the first frame (Unix)");
  section.add("storage", storage,
              {{"embedded", Storage::kEmbedded},
               {"external_png", Storage::kExternalPng},
               {"external_jpeg", Storage::kExternalJpeg}},
              "Where images are kept");
  section.add("jpeg_quality", jpeg_quality, 10, 100, "", "Of colour images");
  section.add("truth_range_m", truth_range_m, 5.0, 300.0, "m", "Objects farther are not labelled");
}

void SimParams::describe(Params& params) {
  route.describe(params.section("route").user());
  world.describe(params.section("world").user());
  traffic.describe(params.section("traffic").user());
  robot.describe(params.section("robot").user());
  camera.describe(params.section("camera").user());
  laser.describe(params.section("laser").user());
  gnss.describe(params.section("gnss").user());
  calibration_error.describe(params.section("calibration_error").user());
  detector.describe(params.section("detector").user());
  recording.describe(params.section("recording").user());
}

void SimParams::validate() const {
  validateRanges(*this);
  if (world.house_height_max_m < world.house_height_min_m) {
    throw InputError("[world] house_height_max_m: less than house_height_min_m");
  }
  if (traffic.van_ratio + traffic.truck_ratio + traffic.bus_ratio > 1.0) {
    throw InputError("[traffic] van_ratio, truck_ratio, bus_ratio: their sum is above 1");
  }
  if (route.kind == RouteParams::Kind::kKittiPoses && route.file.empty()) {
    throw InputError("[route] file: kind kitti_poses needs a file of 3x4 camera poses");
  }
  if (route.kind == RouteParams::Kind::kLoop &&
      2.0 * route.corner_radius_m > std::min(route.loop_length_m, route.loop_width_m)) {
    throw InputError("[route] corner_radius_m: more than half of the loop's shorter side");
  }
  // A standing vehicle takes 12 m of its lane, bus and gap included; there are two lanes.
  const double lanes_hold = 2.0 * (traffic.range_ahead_m + traffic.range_behind_m) / 12.0;
  if (traffic.vehicles > lanes_hold) {
    throw InputError("[traffic] vehicles: " + std::to_string(traffic.vehicles) +
                     " are more than the lanes hold within range_ahead_m and range_behind_m (" +
                     std::to_string(static_cast<int>(lanes_hold)) + ")");
  }
  if (traffic.cyclists > lanes_hold / 2.0) {
    throw InputError("[traffic] cyclists: more than the cycling strips hold (" +
                     std::to_string(static_cast<int>(lanes_hold / 2.0)) + ")");
  }
  if (camera.jitter_s * 6.0 > 1.0 / camera.rate_hz) {
    throw InputError("[camera] jitter_s: so large that frames would change places");
  }
}

}  // namespace headway::sim
