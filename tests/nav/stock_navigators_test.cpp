// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/nav/predictive_obstacles.h>
#include <headway_test/folders.h>
#include <headway_test/process.h>
#include <headway_test/walking_track.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/nav/reactive/CReactiveNavigationSystem.h>
#include <mrpt/nav/reactive/CReactiveNavigationSystem3D.h>

#include <filesystem>

#include "scripted_robot.h"

namespace headway::nav {
namespace {

using mrpt::nav::CAbstractNavigator;
using test::walkingTrack;

const std::string kStockFolder = "/usr/share/mrpt/config_files/navigation-ptgs/";

/// MRPT's navigators with MRPT's own configuration, on a robot that sees nothing but the map.
template <typename Navigator>
class Drive {
 public:
  explicit Drive(const std::string& configuration)
      : obstacles_(
            robot_, [this] { return map_; }, {}, [this] { return wheels_.getTime(); }),
        navigator_(obstacles_, false) {
    obstacles_.setMinLoggingLevel(mrpt::system::LVL_ERROR);
    navigator_.setMinLoggingLevel(mrpt::system::LVL_ERROR);
    mrpt::config::CConfigFileMemory file(test::contentsOf(kStockFolder + configuration));
    file.write("CAbstractPTGBasedReactive", "enable_obstacle_filtering", false);
    navigator_.loadConfigFile(file);
    navigator_.initialize();
    CAbstractNavigator::TNavigationParams request;
    request.target.target_coords = {6.0, 0.0, 0.0};
    request.target.targetAllowedDistance = 0.5f;
    navigator_.navigate(&request);
  }

  /// Drives for up to 40 s; if asked for, a person blocks the path for the first 8 s.
  void run(bool person_in_the_way, double map_stops_at_s = 1e9) {
    for (int step = 0; step < 200; ++step) {
      const double now = wheels_.getTime();
      if (now < map_stops_at_s) map_.update(now, tracksAt(now, person_in_the_way));
      navigator_.navigationStep();
      if (navigator_.getCurrentState() != CAbstractNavigator::NAVIGATING) return;
      wheels_.simulateOneTimeStep(0.2);
      const auto& pose = wheels_.getCurrentGTPose();
      max_lateral_offset = std::max(max_lateral_offset, std::abs(pose.y));
    }
  }

  [[nodiscard]] auto state() const { return navigator_.getCurrentState(); }
  [[nodiscard]] bool stands() { return std::abs(wheels_.getV()) < 1e-3; }

  double max_lateral_offset = 0.0;

 private:
  static std::vector<Track> tracksAt(double now, bool person) {
    if (!person || now > 8.0) return {};
    return {walkingTrack(1, {3.0, 0.1}, {-0.01, 0.0})};
  }

  mrpt::kinematics::CVehicleSimul_DiffDriven wheels_;
  ScriptedRobot robot_{wheels_};
  map::PerceptionMap map_;
  PredictiveObstacles obstacles_;
  Navigator navigator_;
};

template <typename Navigator>
void expectToDrive(const std::string& configuration) {
  if (!std::filesystem::exists(kStockFolder + configuration)) {
    GTEST_SKIP() << kStockFolder << configuration << " is not there: install mrpt-common";
  }
  const test::WorkingInTemporaryFolder folder;  // navigators share tables of their trajectories
  Drive<Navigator> free_drive(configuration);
  free_drive.run(false);
  EXPECT_EQ(free_drive.state(), CAbstractNavigator::IDLE) << "at the goal";

  Drive<Navigator> blocked_drive(configuration);
  blocked_drive.run(true);
  EXPECT_EQ(blocked_drive.state(), CAbstractNavigator::IDLE) << "at the goal";
  EXPECT_GT(blocked_drive.max_lateral_offset, free_drive.max_lateral_offset + 0.2)
      << "it goes round";

  Drive<Navigator> stale_drive(configuration);
  stale_drive.run(false, 2.0);
  EXPECT_NE(stale_drive.state(), CAbstractNavigator::IDLE) << "it must not get there";
  EXPECT_TRUE(stale_drive.stands());
}

TEST(StockNavigatorsTest, Reactive2dDrivesAndStopsOnAStaleMap) {
  expectToDrive<mrpt::nav::CReactiveNavigationSystem>("reactive2d_config.ini");
}

TEST(StockNavigatorsTest, Reactive3dDrivesAndStopsOnAStaleMap) {
  expectToDrive<mrpt::nav::CReactiveNavigationSystem3D>("reactive3d_config.ini");
}

}  // namespace
}  // namespace headway::nav
