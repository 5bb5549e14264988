// SPDX-License-Identifier: BSD-3-Clause
// Everything that a world's .ini says.
#pragma once

#include <headway/core/params.h>

#include <string>

namespace headway::sim {

/// Where the robot drives. Section [route].
struct RouteParams {
  enum class Kind { kLane, kLoop, kKittiPoses };

  Kind kind = Kind::kLane;
  std::string shape = "straight 60, left 60 50, straight 40, right 50 70, straight 80";
  double loop_length_m = 160.0;  ///< long side of the loop's rectangle
  double loop_width_m = 110.0;   ///< short side
  double corner_radius_m = 15.0;
  int laps = 1;
  std::string file;                        ///< KITTI poses, one 3x4 matrix a row
  double speed_mps = 7.0;                  ///< the robot's speed on a free, straight street
  double lateral_acceleration_mps2 = 2.0;  ///< maximum in curves [m/s^2]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "route"); }  ///< @throws InputError
};

/// What stands along the streets. Section [world].
struct WorldParams {
  enum class Kind { kStreet, kHall, kCampus, kWarehouse };

  Kind kind = Kind::kStreet;
  int seed = 1;
  double view_distance_m = 140.0;      ///< nothing farther is drawn
  double cross_street_every_m = 75.0;  ///< 0: none
  double house_ratio = 0.9;            ///< of the frontage that houses take
  double house_height_min_m = 7.0;
  double house_height_max_m = 15.0;
  double tree_every_m = 14.0;  ///< along one side; 0: none
  double parked_ratio = 0.45;  ///< of the parking bays
  double hill_height_m = 0.0;  ///< rise and fall of lane and loop routes
  double fence_ratio = 0.0;    ///< of the frontage with picket fences or railings before it
  double moved_ratio = 0.0;    ///< of the furniture and loads, otherwise than the seed places them
  int machines = 0;            ///< of random shapes beside the walls of hall, campus, warehouse
  bool identical_racks = false;  ///< a warehouse's bays are all loaded like the first

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "world"); }  ///< @throws InputError
};

/// Who moves. Section [traffic]. Numbers are of actors near the robot at the same time.
struct TrafficParams {
  int vehicles = 6;  ///< driving cars, vans, trucks and buses
  int cyclists = 1;
  int pedestrians = 8;
  double van_ratio = 0.15;  ///< of the vehicles
  double truck_ratio = 0.06;
  double bus_ratio = 0.04;
  double oncoming_ratio = 0.5;  ///< of the vehicles on the robot's street
  double crossing_ratio = 0.2;  ///< of the vehicles: they come out of cross streets
  double turning_ratio = 0.2;   ///< of the vehicles on the robot's street that turn off
  double vehicle_speed_mps = 8.0;
  double walking_speed_mps = 1.34;      ///< mean; Weidmann 1993
  double road_crossing_rate_hz = 0.02;  ///< how often a walker decides to cross the street
  double group_ratio = 0.35;            ///< of the pedestrians that walk in groups
  double stop_rate_hz = 0.02;           ///< how often a walker stops for a moment
  int in_front_at_start = 0;            ///< actors right before the camera at the start
  double image_share = 0.0;             ///< of the left image that actors cover; 0: as it comes
  double cover = 0.0;   ///< of the view, by people who walk before the camera; not in streets
  int idle_people = 0;  ///< of hall, campus, warehouse: they sit or stand about
  bool varied_bodies = false;     ///< people of 1.1 to 2.0 m: broad, bent, carrying, in wheelchairs
  double encounter_ratio = 0.35;  ///< of their walkers' ways, those that meet the robot
  double range_ahead_m = 100.0;   ///< actors live up to here ahead of the robot
  double range_behind_m = 25.0;

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "traffic"); }  ///< @throws InputError
};

/// How a robot moves through hall, campus and warehouse. Section [robot].
///
/// It drives from place to place along straight lines and turns on the spot between them; its top
/// speed is [route] speed_mps.
struct RobotParams {
  bool standing = false;              ///< it never moves; in streets, too
  int tour_stops = 0;                 ///< of a tour that it repeats; 0: from stop to stop at random
  double turn_rate_dps = 90.0;        ///< maximum, on the spot [deg/s]
  double acceleration_mps2 = 1.0;     ///< [m/s^2]
  double brake_mps2 = 3.0;            ///< hard braking: before people, and without cause [m/s^2]
  double sudden_stop_rate_hz = 0.04;  ///< how often it brakes hard without cause

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "robot"); }  ///< @throws InputError
};

/// A 2D laser scanner near the ground, one scan with each stereo frame. Section [laser].
struct LaserParams {
  bool enabled = false;
  double aperture_deg = 270.0;  ///< about the robot's forward axis
  int rays = 541;
  double min_range_m = 0.2;
  double max_range_m = 10.0;
  double sigma_m = 0.015;     ///< of a range
  double miss_ratio = 0.005;  ///< of the rays, without return
  double height_m = 0.18;     ///< above the ground
  double forward_m = 0.1;

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "laser"); }  ///< @throws InputError
};

/// A satellite receiver. Section [gnss].
struct GnssParams {
  bool enabled = false;
  double rate_hz = 5.0;
  double sigma_m = 1.0;         ///< noise of each horizontal axis; of the height, 1.7 times as much
  double outlier_ratio = 0.05;  ///< of the fixes
  double outlier_m = 30.0;      ///< outliers are displaced by up to this
  double forward_m = 0.0;       ///< antenna before the robot's origin
  double height_m = 1.0;        ///< antenna above the robot's origin
  double latitude_deg = 48.0;   ///< of the world's origin
  double longitude_deg = 11.0;
  double altitude_m = 500.0;
  double heading_deg = 30.0;  ///< of the world's x axis, clockwise from north

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "gnss"); }  ///< @throws InputError
};

/// The stereo rig and what it does to the picture. Section [camera].
struct CameraParams {
  int width = 1240;  ///< [px]
  int height = 376;  ///< [px]
  double focal_px = 718.0;
  double baseline_m = 0.54;
  double mount_height_m = 1.65;  ///< above the ground
  double mount_forward_m = 0.0;
  double pitch_down_deg = 0.0;  ///< optical axes below the horizontal
  double rate_hz = 10.0;
  double ride_deg = 0.25;         ///< pitching and rolling of the body, standard deviation
  double noise_grey = 2.0;        ///< sensor noise, standard deviation [grey levels]
  double gain_difference = 0.02;  ///< right image brighter than left by this ratio
  double vignetting = 0.1;        ///< loss of light in the corners
  double exposure_change = 0.0;   ///< slow change of brightness, ratio
  double gamma = 1.0;             ///< of the brightness; above 1: darker
  int blur_samples = 1;           ///< drawings averaged over the exposure; 1: no motion blur
  double exposure_s = 0.01;
  double k1 = 0.0;  ///< radial distortion; any non-zero: raw images are recorded
  double k2 = 0.0;
  double drop_ratio = 0.0;        ///< of the frames, lost
  double jitter_s = 0.0;          ///< standard deviation of the frames' times
  bool odometry = false;          ///< record wheel odometry
  double wheel_slip_ratio = 0.0;  ///< of the time, the wheels turn twice as fast as the robot moves
  bool imu = false;               ///< record an inertial sensor, 100 Hz
  bool colour = true;
  bool depth_camera = false;   ///< record images with depth instead of pairs
  double depth_noise = 0.002;  ///< of a depth, standard deviation by its square [1/m]
  double depth_min_m = 0.4;    ///< nearest depth measured [m]
  double depth_max_m = 8.0;    ///< farthest [m]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "camera"); }  ///< @throws InputError
};

/// How the rig differs from the calibration that is recorded with its images, as every real one
/// does. Section [calibration_error].
///
/// Depths, boxes and poses stay true of the left camera.
/// @see Kreso & Segvic 2015, "Improving the egomotion estimation by correcting the calibration
///      bias": what is left over after KITTI's calibration, and what it does to odometry
struct CalibrationErrorParams {
  double focal_ratio = 0.0;      ///< true focal length above the recorded one by this ratio
  double baseline_ratio = 0.0;   ///< true baseline above the recorded one by this ratio
  double right_roll_deg = 0.0;   ///< right camera rotated about its viewing direction
  double right_pitch_deg = 0.0;  ///< right camera rotated up
  double right_yaw_deg = 0.0;    ///< right camera rotated to its right
  double flex_deg = 0.0;  ///< rig bends from frame to frame: standard deviation about each axis

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "calibration_error"); }  ///< @throws InputError
};

/// Errors of a detection network on the images. Section [detector].
struct DetectorParams {
  double max_range_m = 70.0;
  double min_height_px = 12.0;
  double position_sigma_m = 0.15;  ///< across the ray at 20 m and nearer; grows with depth
  double depth_sigma_m = 0.35;     ///< along the ray at 20 m and nearer; grows with depth
  double size_sigma = 0.05;        ///< ratio of length, width and height
  double yaw_sigma_rad = 0.08;
  double box_sigma_px = 1.5;   ///< of the 2D box's edges
  double miss_near = 0.03;     ///< ratio missed when near and in full view
  double miss_far = 0.35;      ///< ratio missed at max_range_m, in full view
  double miss_occluded = 0.9;  ///< ratio missed when hardly anything is visible
  double duplicate_probability = 0.05;
  double false_per_frame = 0.15;
  double flip_probability = 0.03;       ///< headings turned by 180 degrees
  double id_switch_probability = 0.01;  ///< tracks that get a new id in a frame
  bool boxes_2d = true;
  bool boxes_3d = true;
  bool parked = true;  ///< parked vehicles are detected, too

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "detector"); }  ///< @throws InputError
};

/// What is written. Section [recording].
struct RecordingParams {
  enum class Storage { kEmbedded, kExternalPng, kExternalJpeg };

  int frames = 120;
  int first_frame = 0;  ///< frames before it pass undrawn; the map begins where it is taken
  double start_time_s = 1700000000.0;
  Storage storage = Storage::kEmbedded;
  int jpeg_quality = 90;
  double truth_range_m = 90.0;  ///< objects farther ahead are not in the truth

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "recording"); }  ///< @throws InputError
};

/// Everything that a world's .ini says.
struct SimParams {
  RouteParams route;
  WorldParams world;
  TrafficParams traffic;
  RobotParams robot;
  CameraParams camera;
  LaserParams laser;
  GnssParams gnss;
  CalibrationErrorParams calibration_error;
  DetectorParams detector;
  RecordingParams recording;

  void describe(Params& params);
  /// Throws InputError naming the keys of values that are each in range but not together.
  void validate() const;
};

}  // namespace headway::sim
