#pragma once

#include <headway/nav/predictive_obstacles.h>
#include <headway/objects/objects_params.h>
#include <headway/sim/crowd.h>
#include <mrpt/math/TPose2D.h>

#include <functional>
#include <memory>

#include "trial_params.h"

namespace headway::app {

/// What became of one trial.
struct TrialResult {
  std::uint64_t seed = 0;
  bool goal_reached = false;
  double time_to_goal_s = 0.0;   ///< the time limit if the goal was not reached
  double min_distance_m = 0.0;   ///< least distance between a body and the robot's; 0: contact
  bool collided = false;         ///< a body and the moving robot overlapped
  bool walked_into = false;      ///< a body and the standing robot overlapped
  bool pillar_touched = false;   ///< a pillar and the robot overlapped
  std::size_t unsafe_steps = 0;  ///< planning steps with obstacles not to be trusted
  std::vector<double> step_us;   ///< processor time of each planning step, without scanning [us]
  std::vector<double> sense_us;  ///< of that, what PredictiveObstacles takes [us]
};

/// One planning step, for pictures.
struct TrialMoment {
  double time_s = 0.0;
  mrpt::math::TPose2D robot;
  std::vector<sim::Person> people;
  std::vector<sim::Pillar> pillars;
  std::vector<Track> tracks;
  std::vector<Eigen::Vector2d> obstacles;  ///< as the planner gets them, map frame [m]
  bool contact = false;                    ///< with somebody, since the last moment
};

using TrialObserver = std::function<void(const TrialMoment&)>;

/// Everything that a trial is made with.
struct TrialSetup {
  TrialParams world;
  nav::PredictiveObstaclesParams nav;
  objects::ObjectsParams objects;
};

/// Drives the robot to its goal among people, the tracker in the loop.
///
/// Deterministic but for the processor times; a trial does not depend on those run before it. Runs
/// MRPT's clock by hand meanwhile, so only one trial of a process can be under way.
class TrialRunner {
 public:
  explicit TrialRunner(const TrialSetup& setup);
  ~TrialRunner();

  /// @param observer  told of every planning step; may be empty
  [[nodiscard]] TrialResult run(std::uint64_t seed, const TrialObserver& observer = {});

 private:
  class Machine;
  class Trial;
  std::unique_ptr<Machine> machine_;
};

/// Distance from a disc to the robot's body; 0 if they overlap [m].
[[nodiscard]] double clearance(const RobotParams& robot, const mrpt::math::TPose2D& pose,
                               const Eigen::Vector2d& centre, double radius);

}  // namespace headway::app
