// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/core/Clock.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/nav/reactive/CRobot2NavInterfaceForSimulator.h>

#include <limits>
#include <vector>

namespace headway::nav {

/// A robot whose sensor data are set by the test.
class ScriptedRobot : public mrpt::nav::CRobot2NavInterfaceForSimulator_DiffDriven {
 public:
  explicit ScriptedRobot(mrpt::kinematics::CVehicleSimul_DiffDriven& wheels)
      : CRobot2NavInterfaceForSimulator_DiffDriven(wheels) {
    setMinLoggingLevel(mrpt::system::LVL_ERROR);
  }

  bool senseObstacles(mrpt::maps::CSimplePointsMap& obstacles,
                      mrpt::system::TTimeStamp& timestamp) override {
    obstacles.clear();
    for (const auto& point : sensed) {
      obstacles.insertPoint(static_cast<float>(point.x), static_cast<float>(point.y), 0.4f);
    }
    timestamp = mrpt::Clock::now();
    return can_sense;
  }

  bool getCurrentPoseAndSpeeds(mrpt::math::TPose2D& pose, mrpt::math::TTwist2D& velocity,
                               mrpt::system::TTimeStamp& timestamp, mrpt::math::TPose2D& odometry,
                               std::string& frame_id) override {
    if (!CRobot2NavInterfaceForSimulator_DiffDriven::getCurrentPoseAndSpeeds(
            pose, velocity, timestamp, odometry, frame_id)) {
      return false;
    }
    if (!frame.empty()) frame_id = frame;
    if (pose_is_nan) pose.x = std::numeric_limits<double>::quiet_NaN();
    return knows_pose;
  }

  bool stop(bool is_emergency) override {
    ++stops;
    return CRobot2NavInterfaceForSimulator_DiffDriven::stop(is_emergency);
  }

  std::vector<mrpt::math::TPoint2D> sensed;  ///< in the robot's frame [m]
  bool can_sense = true;
  bool knows_pose = true;
  bool pose_is_nan = false;
  std::string frame;
  int stops = 0;
};

}  // namespace headway::nav
