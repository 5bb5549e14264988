// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/nav/reactive/CReactiveNavigationSystem.h>

#include "trial_params.h"

namespace headway::app {

/// MRPT's reactive navigator without log output, reset for each trial.
///
/// The settings are those of MRPT's reactive2d_config.ini except for the robot's shape and speeds,
/// and the obstacle filter, which is off because it removes objects that move between two scans.
class Navigator : public mrpt::nav::CReactiveNavigationSystem {
 public:
  /// Computes the tables of paths, which takes about a second.
  Navigator(mrpt::nav::CRobot2NavInterface& robot, const RobotParams& params);

  /// Resets the state and starts towards the goal straight ahead of the start.
  void startAfresh(const RobotParams& robot);

 private:
  mrpt::config::CConfigFileMemory settings_;
};

}  // namespace headway::app
