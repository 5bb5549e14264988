#pragma once

#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/nav/reactive/CReactiveNavigationSystem.h>

#include "trial_params.h"

namespace headway::app {

/// MRPT's reactive navigator, silent and able to begin each trial afresh.
///
/// Its settings are those of MRPT's reactive2d_config.ini but for the robot's shape and speeds, and
/// for the filter of obstacles, which is off: it takes away what moves between two scans.
class Navigator : public mrpt::nav::CReactiveNavigationSystem {
 public:
  /// Computes the tables of paths, which takes a moment.
  Navigator(mrpt::nav::CRobot2NavInterface& robot, const RobotParams& params);

  /// Forgets what it did before and sets out for the goal straight ahead of the start.
  void startAfresh(const RobotParams& robot);

 private:
  mrpt::config::CConfigFileMemory settings_;
};

}  // namespace headway::app
