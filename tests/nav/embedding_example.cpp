// SPDX-License-Identifier: BSD-3-Clause
// Embedding headway's predictions in an MRPT navigation program; doc/navigation.md explains it.

#include <headway/map/shared_map.h>
#include <headway/nav/predictive_obstacles.h>
#include <mrpt/nav/reactive/CReactiveNavigationSystem.h>

/// Drives the robot to a goal, among moving objects. `robot` is your own interface;
/// perception, in its own thread, does `map.publish(perception.map())` after each frame.
bool driveTo(const mrpt::math::TPose2D& goal, mrpt::nav::CRobot2NavInterface& robot,
             const headway::map::SharedMap& map, const mrpt::config::CConfigFileBase& settings,
             const std::function<bool()>& wait_for_next_step) {
  headway::nav::PredictiveObstaclesParams params;
  params.robot.radius_m = 0.35;  // holds the whole robot
  params.robot.length_m = 0.5;
  params.robot.width_m = 0.45;
  params.robot.max_speed_mps = 1.0;  // as in robotMax_V_mps
  headway::nav::PredictiveObstacles foresight(
      robot, [&] { return *map.snapshot(); }, params);

  mrpt::nav::CReactiveNavigationSystem navigator(foresight, false);
  navigator.loadConfigFile(settings);
  navigator.initialize();
  mrpt::nav::CAbstractNavigator::TNavigationParams request;
  request.target.target_coords = goal;
  navigator.navigate(&request);
  while (navigator.getCurrentState() == mrpt::nav::CAbstractNavigator::NAVIGATING) {
    navigator.navigationStep();
    if (!wait_for_next_step()) break;
  }
  return navigator.getCurrentState() == mrpt::nav::CAbstractNavigator::IDLE;
}
