// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/params.h>
#include <headway/sim/crowd.h>

namespace headway::app {

/// The robot and its goal, section "robot".
struct RobotParams {
  double length_m = 0.5;
  double width_m = 0.4;
  double margin_m = 0.0;        ///< that the navigator adds around the robot [m]
  double max_speed_mps = 1.0;   ///< [m/s]
  double max_turn_dps = 120.0;  ///< [deg/s]
  double lag_s = 0.15;          ///< time constant of its wheels' speed control [s]
  double goal_m = 12.0;         ///< straight ahead of the start [m]
  double planning_rate_hz = 20.0;
  double planning_reach_m = 10.0;  ///< planning distance; the braking distance scales with it
  double time_limit_s = 60.0;      ///< duration of a trial [s]

  /// Radius of the smallest circle about its origin that encloses it [m].
  [[nodiscard]] double radius() const;
  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "robot"); }  ///< @throws InputError
};

/// Range scanner and detector of people, section "sensors".
struct SensorParams {
  double scan_range_m = 10.0;  ///< of the scanner [m]
  double scan_sigma_m = 0.02;  ///< [m]
  double detection_rate_hz = 10.0;
  double detection_range_m = 12.0;        ///< [m]
  double field_of_view_deg = 360.0;       ///< of the detector, centred straight ahead
  double along_sigma_m = 0.08;            ///< noise of a detected position along the ray [m]
  double along_sigma_per_m = 0.01;        ///< its growth with distance [m/m]
  double across_ratio = 0.5;              ///< noise across the ray over that along it [-]
  double size_sigma_m = 0.05;             ///< [m]
  double yaw_sigma_deg = 15.0;            ///< [deg]
  double flip_probability = 0.05;         ///< of reversing a heading [-]
  double miss_probability = 0.1;          ///< of not detecting a person [-]
  double duplicate_probability = 0.03;    ///< of detecting a person twice, about 0.5 m apart [-]
  double false_alarm_probability = 0.01;  ///< of a false alarm in a frame [-]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "sensors"); }  ///< @throws InputError
};

/// Everything that defines a trial but its seed.
struct TrialParams {
  RobotParams robot;
  sim::PeopleParams people;
  SensorParams sensors;

  void describe(Params& params);
  void validate() const { validateRanges(*this); }  ///< @throws InputError
};

}  // namespace headway::app
