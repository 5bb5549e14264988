// SPDX-License-Identifier: BSD-3-Clause
#include "scanning_robot.h"

#include <headway/core/stage_times.h>
#include <mrpt/core/Clock.h>

#include <cmath>

namespace headway::app {
namespace {

constexpr double kStandingSpeed = 0.02;  ///< a slower robot stands [m/s]
constexpr double kStandingTurn = 0.05;   ///< [rad/s]

}  // namespace

ScanningRobot::ScanningRobot(const RobotParams& params)
    : ScanningRobot(std::make_unique<mrpt::kinematics::CVehicleSimul_DiffDriven>()) {
  wheels_.setDelayModelParams(params.lag_s, 0.0);
}

ScanningRobot::ScanningRobot(std::unique_ptr<mrpt::kinematics::CVehicleSimul_DiffDriven> wheels)
    : CRobot2NavInterfaceForSimulator_DiffDriven(*wheels),
      owned_wheels_(std::move(wheels)),
      wheels_(*owned_wheels_) {}

void ScanningRobot::start(const sim::Crowd& crowd, const RangeScanner& scanner) {
  crowd_ = &crowd;
  scanner_ = scanner;
  wheels_.resetStatus();
  wheels_.resetTime();
  wheels_.setCurrentGTPose({0.0, 0.0, 0.0});
  wheels_.movementCommand(0.0, 0.0);
}

bool ScanningRobot::senseObstacles(mrpt::maps::CSimplePointsMap& obstacles,
                                   mrpt::system::TTimeStamp& timestamp) {
  const double start = processorSeconds();
  scanner_->scan(*crowd_, pose(), obstacles);
  timestamp = mrpt::Clock::now();
  scan_us_ = 1e6 * (processorSeconds() - start);
  return true;
}

bool ScanningRobot::moves() {
  return std::abs(wheels_.getV()) > kStandingSpeed || std::abs(wheels_.getW()) > kStandingTurn;
}

}  // namespace headway::app
