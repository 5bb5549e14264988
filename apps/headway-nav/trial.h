// SPDX-License-Identifier: BSD-3-Clause
// Trials: a robot drives to its goal among people, with the tracker in the loop.
#pragma once

#include <headway/core/params.h>
#include <headway/nav/predictive_obstacles.h>
#include <headway/objects/objects_params.h>
#include <headway/sim/crowd.h>
#include <mrpt/math/TPose2D.h>

#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "contacts.h"
#include "navigator.h"

namespace headway::app {

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

/// What is known of a trial in a simulated world besides.
struct DriveResult {
  ContactCounts contacts;
  double course_m = 0.0;      ///< length of the way to the goal
  double goal_error_m = 0.0;  ///< true distance to the goal at the end
  double lost_s = 0.0;        ///< time in which the robot did not know where it is
};

/// Result of one trial.
struct TrialResult {
  std::uint64_t seed = 0;
  bool goal_reached = false;
  double time_to_goal_s = 0.0;       ///< the time limit if the goal was not reached
  double min_distance_m = 0.0;       ///< min. distance between people and the robot; 0: contact
  bool collided = false;             ///< a person and the moving robot overlapped
  bool walked_into = false;          ///< a person and the robot at rest overlapped
  bool pillar_touched = false;       ///< a pillar and the robot overlapped
  std::size_t unsafe_steps = 0;      ///< planning steps with invalid obstacles
  std::optional<DriveResult> drive;  ///< of a trial in a simulated world
  std::vector<double> step_us;   ///< processor time of each planning step, without scanning [us]
  std::vector<double> sense_us;  ///< of that, the time of PredictiveObstacles [us]

  /// The values that follow from the contacts of a drive.
  void applyContacts() {
    const ContactCounts& contacts = drive->contacts;
    min_distance_m = contacts.min_distance_m;
    collided = contacts.by_robot > 0;
    walked_into = contacts.by_others > 0;
    pillar_touched = contacts.with_things > 0;
  }
};

/// What stays as it is during a trial, for pictures; map frame.
struct TrialScene {
  Eigen::Vector2d goal = Eigen::Vector2d::Zero();  ///< [m]
  std::vector<Eigen::Vector2d> course;             ///< way to it [m]; empty: straight
  std::vector<sim::Footprint> things;              ///< impassable
};

/// One planning step, for pictures.
struct TrialMoment {
  std::shared_ptr<const TrialScene> scene;
  double time_s = 0.0;
  mrpt::math::TPose2D robot;
  std::vector<sim::Person> people;
  std::vector<sim::Pillar> pillars;
  std::vector<Track> tracks;
  std::vector<Eigen::Vector2d> obstacles;  ///< of the planner, map frame [m]
  bool contact = false;                    ///< with a person, since the previous step
  cv::Mat image;                           ///< of the robot's camera, small; may be empty
  cv::Mat1b ground;                        ///< see groundAbout(); may be empty
};

using TrialObserver = std::function<void(const TrialMoment&)>;

/// Parameters of a trial.
struct TrialSetup {
  TrialParams world;
  nav::PredictiveObstaclesParams nav;
  objects::ObjectsParams objects;
};

/// Runs trials of one kind with one policy.
class Trials {
 public:
  virtual ~Trials() = default;
  /// @param observer  called for every planning step; may be empty
  [[nodiscard]] virtual TrialResult run(std::uint64_t seed, const TrialObserver& observer) = 0;
};

/// Drives the robot to its goal among people, with the tracker in the loop.
///
/// Deterministic except for processor times; a trial does not depend on the ones before. Controls
/// MRPT's clock during a trial, so that a process can run only one trial at a time.
class TrialRunner : public Trials {
 public:
  explicit TrialRunner(const TrialSetup& setup);
  ~TrialRunner() override;

  [[nodiscard]] TrialResult run(std::uint64_t seed, const TrialObserver& observer = {}) override;

 private:
  class Machine;
  class Trial;
  std::unique_ptr<Machine> machine_;
};

}  // namespace headway::app
