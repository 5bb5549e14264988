// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/nav/reactive/CRobot2NavInterfaceForSimulator.h>

#include <optional>

#include "range_scanner.h"

namespace headway::app {

/// MRPT's simulated robot with a range scanner, reset for each trial.
class ScanningRobot : public mrpt::nav::CRobot2NavInterfaceForSimulator_DiffDriven {
 public:
  explicit ScanningRobot(const RobotParams& params);

  /// Puts the robot, at rest, at the origin of a new world; `crowd` must outlive the trial.
  void start(const sim::Crowd& crowd, const RangeScanner& scanner);

  bool senseObstacles(mrpt::maps::CSimplePointsMap& obstacles,
                      mrpt::system::TTimeStamp& timestamp) override;

  void moveOn(double dt_s) { wheels_.simulateOneTimeStep(dt_s); }

  [[nodiscard]] const mrpt::math::TPose2D& pose() const { return wheels_.getCurrentGTPose(); }
  /// Whether it drives or turns.
  [[nodiscard]] bool moves();

  /// Processor time of simulating the last scan [us].
  [[nodiscard]] double scanTime_us() const { return scan_us_; }

  // Events that MRPT would report on standard output.
  bool startWatchdog(float) override { return true; }
  bool stopWatchdog() override { return true; }
  void sendNavigationStartEvent() override {}
  void sendNavigationEndEvent() override {}
  void sendNavigationEndDueToErrorEvent() override {}
  void sendWaySeemsBlockedEvent() override {}
  void sendApparentCollisionEvent() override {}
  void sendCannotGetCloserToBlockedTargetEvent() override {}

 private:
  explicit ScanningRobot(std::unique_ptr<mrpt::kinematics::CVehicleSimul_DiffDriven> wheels);

  std::unique_ptr<mrpt::kinematics::CVehicleSimul_DiffDriven> owned_wheels_;
  mrpt::kinematics::CVehicleSimul_DiffDriven& wheels_;
  const sim::Crowd* crowd_ = nullptr;
  std::optional<RangeScanner> scanner_;
  double scan_us_ = 0.0;
};

}  // namespace headway::app
