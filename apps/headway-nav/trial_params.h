#pragma once

#include <headway/core/params.h>
#include <headway/sim/crowd.h>

namespace headway::app {

/// The robot and its way, section "robot".
struct RobotParams {
  double length_m = 0.5;
  double width_m = 0.4;
  double margin_m = 0.0;        ///< that the navigator keeps about the body [m]
  double top_speed = 1.0;       ///< [m/s]
  double top_turn_dps = 120.0;  ///< [deg/s]
  double lag_s = 0.15;          ///< time constant of its wheels [s]
  double goal_m = 12.0;         ///< straight ahead of the start [m]
  double planning_rate_hz = 20.0;
  double planning_reach_m = 10.0;  ///< how far the navigator looks; its slowing down scales with it
  double time_limit_s = 60.0;      ///< a goal reached later is not reached [s]

  /// Radius about its origin that holds its body [m].
  [[nodiscard]] double radius() const;
  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "robot"); }  ///< @throws InputError
};

/// What the robot sees, section "sensors".
struct SensorParams {
  double scan_range_m = 10.0;  ///< of the scanner that gives the points of now [m]
  double scan_sigma_m = 0.02;  ///< [m]
  double detection_rate_hz = 10.0;
  double detection_range_m = 12.0;   ///< [m]
  double field_of_view_deg = 360.0;  ///< of the detector, about straight ahead
  double along_sigma_m = 0.08;       ///< noise of a detected place along the ray [m]
  double along_sigma_per_m = 0.01;   ///< its growth with distance [m/m]
  double across_share = 0.5;         ///< noise across the ray, share of that along it [-]
  double size_sigma_m = 0.05;        ///< [m]
  double yaw_sigma_deg = 15.0;       ///< [deg]
  double flip_share = 0.05;          ///< headings turned round [-]
  double miss_share = 0.1;           ///< people not detected [-]
  double double_share = 0.03;        ///< people detected twice, 0.5 m apart or so [-]
  double false_share = 0.01;         ///< frames with a detection of nobody [-]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "sensors"); }  ///< @throws InputError
};

/// A trial, whatever its seed.
struct TrialParams {
  RobotParams robot;
  sim::PeopleParams people;
  SensorParams sensors;

  void describe(Params& params);
  void validate() const { validateRanges(*this); }  ///< @throws InputError
};

}  // namespace headway::app
