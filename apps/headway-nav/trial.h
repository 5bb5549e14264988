// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/nav/predictive_obstacles.h>
#include <headway/objects/objects_params.h>
#include <headway/sim/crowd.h>
#include <mrpt/math/TPose2D.h>

#include <functional>
#include <memory>

#include "trial_params.h"

namespace headway::app {

/// Result of one trial.
struct TrialResult {
  std::uint64_t seed = 0;
  bool goal_reached = false;
  double time_to_goal_s = 0.0;   ///< the time limit if the goal was not reached
  double min_distance_m = 0.0;   ///< min. distance between people and the robot; 0: contact
  bool collided = false;         ///< a person and the moving robot overlapped
  bool walked_into = false;      ///< a person and the robot at rest overlapped
  bool pillar_touched = false;   ///< a pillar and the robot overlapped
  std::size_t unsafe_steps = 0;  ///< planning steps with invalid obstacles
  std::vector<double> step_us;   ///< processor time of each planning step, without scanning [us]
  std::vector<double> sense_us;  ///< of that, the time of PredictiveObstacles [us]
};

/// One planning step, for pictures.
struct TrialMoment {
  double time_s = 0.0;
  mrpt::math::TPose2D robot;
  std::vector<sim::Person> people;
  std::vector<sim::Pillar> pillars;
  std::vector<Track> tracks;
  std::vector<Eigen::Vector2d> obstacles;  ///< of the planner, map frame [m]
  bool contact = false;                    ///< with a person, since the previous step
};

using TrialObserver = std::function<void(const TrialMoment&)>;

/// Parameters of a trial.
struct TrialSetup {
  TrialParams world;
  nav::PredictiveObstaclesParams nav;
  objects::ObjectsParams objects;
};

/// Drives the robot to its goal among people, with the tracker in the loop.
///
/// Deterministic except for processor times; a trial does not depend on the ones before. Controls
/// MRPT's clock during a trial, so that a process can run only one trial at a time.
class TrialRunner {
 public:
  explicit TrialRunner(const TrialSetup& setup);
  ~TrialRunner();

  /// @param observer  called for every planning step; may be empty
  [[nodiscard]] TrialResult run(std::uint64_t seed, const TrialObserver& observer = {});

 private:
  class Machine;
  class Trial;
  std::unique_ptr<Machine> machine_;
};

/// Distance from a disc to the robot's footprint; 0 if they overlap [m].
[[nodiscard]] double clearance(const RobotParams& robot, const mrpt::math::TPose2D& pose,
                               const Eigen::Vector2d& centre, double radius);

}  // namespace headway::app
