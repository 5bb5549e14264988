// SPDX-License-Identifier: BSD-3-Clause
// The calls that PredictiveObstacles forwards to the wrapped robot.

#include <headway/nav/predictive_obstacles.h>

namespace headway::nav {

using mrpt::kinematics::CVehicleVelCmd;

bool PredictiveObstacles::getCurrentPoseAndSpeeds(mrpt::math::TPose2D& pose,
                                                  mrpt::math::TTwist2D& velocity,
                                                  mrpt::system::TTimeStamp& timestamp,
                                                  mrpt::math::TPose2D& odometry,
                                                  std::string& frame_id) {
  return robot_.getCurrentPoseAndSpeeds(pose, velocity, timestamp, odometry, frame_id);
}

bool PredictiveObstacles::stop(bool is_emergency) {
  command_.reset();
  return robot_.stop(is_emergency);
}

CVehicleVelCmd::Ptr PredictiveObstacles::getEmergencyStopCmd() {
  return robot_.getEmergencyStopCmd();
}

CVehicleVelCmd::Ptr PredictiveObstacles::getStopCmd() { return robot_.getStopCmd(); }

CVehicleVelCmd::Ptr PredictiveObstacles::getAlignCmd(double relative_heading) {
  return robot_.getAlignCmd(relative_heading);
}

bool PredictiveObstacles::startWatchdog(float period_ms) { return robot_.startWatchdog(period_ms); }

bool PredictiveObstacles::stopWatchdog() { return robot_.stopWatchdog(); }

void PredictiveObstacles::sendNavigationStartEvent() { robot_.sendNavigationStartEvent(); }

void PredictiveObstacles::sendNavigationEndEvent() { robot_.sendNavigationEndEvent(); }

void PredictiveObstacles::sendWaypointReachedEvent(int index, bool reached) {
  robot_.sendWaypointReachedEvent(index, reached);
}

void PredictiveObstacles::sendNewWaypointTargetEvent(int index) {
  robot_.sendNewWaypointTargetEvent(index);
}

void PredictiveObstacles::sendNavigationEndDueToErrorEvent() {
  robot_.sendNavigationEndDueToErrorEvent();
}

void PredictiveObstacles::sendWaySeemsBlockedEvent() { robot_.sendWaySeemsBlockedEvent(); }

void PredictiveObstacles::sendApparentCollisionEvent() { robot_.sendApparentCollisionEvent(); }

void PredictiveObstacles::sendCannotGetCloserToBlockedTargetEvent() {
  robot_.sendCannotGetCloserToBlockedTargetEvent();
}

double PredictiveObstacles::getNavigationTime() { return robot_.getNavigationTime(); }

void PredictiveObstacles::resetNavigationTimer() { robot_.resetNavigationTimer(); }

}  // namespace headway::nav
