// SPDX-License-Identifier: BSD-3-Clause
// A drive: a robot in a simulated world finds its way by what it perceives there.
#pragma once

#include <headway/sim/sim_params.h>

#include "eyes.h"
#include "trial.h"

namespace headway::app {

/// Everything that defines a drive but its seed.
struct DriveSetup {
  sim::SimParams world;  ///< its seed is the trial's
  Sense sense = Sense::kImages;
  bool local_layer = true;  ///< by images: with what each frame shows to be blocked
  RobotParams robot;
  nav::PredictiveObstaclesParams nav;
  objects::ObjectsParams objects;
};

/// Drives the robot along the course of a simulated world: it sees, decides and moves, frame by
/// frame.
///
/// MRPT's navigator is led along the course, as by a planner with a floor plan; around people and
/// things it finds its own way, by the obstacles of the map that the robot has so far. There is no
/// time between a frame and the command that follows from it. While the robot does not know where
/// it is, it stands for 2 s and then turns on the spot. Frames are taken at the camera's rate, or
/// at that of planning if it is lower.
///
/// Deterministic except for processor times; controls MRPT's clock during a drive.
class DriveRunner : public Trials {
 public:
  /// About the robot for its navigator: obstacles are middles of cells, half as wide as the map's,
  /// and people are thinner to the eye than their shoulders are wide.
  static constexpr double kMargin_m = 0.12;

  explicit DriveRunner(const DriveSetup& setup) : setup_(setup) {
    setup_.robot.reverses = false;
    setup_.robot.margin_m += kMargin_m;
  }

  [[nodiscard]] TrialResult run(std::uint64_t seed, const TrialObserver& observer = {}) override;

 private:
  DriveSetup setup_;
};

}  // namespace headway::app
