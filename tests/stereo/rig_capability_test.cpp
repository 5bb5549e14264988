// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/stereo/rig_capability.h>
#include <headway_test/paths.h>

#include <cstdio>
#include <fstream>
#include <sstream>

namespace headway::stereo {
namespace {

struct Mounting {
  double height_m;
  double pitch_deg;  ///< down
};

StereoCamera cameraOf(int width, int height, double focal, double baseline, Mounting mounting) {
  StereoCamera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = focal;
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  camera.baseline_m = baseline;
  camera.T_robot_cam =
      Eigen::Translation3d(0.0, 0.0, mounting.height_m) *
      Eigen::AngleAxisd(mounting.pitch_deg * M_PI / 180.0, Eigen::Vector3d::UnitY()) *
      robotFromOptical();
  return camera;
}

const StereoCamera kCar = cameraOf(1241, 376, 718.0, 0.54, {1.65, 0.0});
const StereoCamera kRobot = cameraOf(1280, 720, 700.0, 0.12, {0.5, 10.0});
const StereoCamera kSmall = cameraOf(640, 480, 450.0, 0.05, {0.3, 0.0});

TEST(RigCapabilityTest, TheCarHasTheRangesItWasTunedTo) {
  const auto rig = rigCapability(kCar);
  EXPECT_DOUBLE_EQ(rig.min_obstacle_height_m, 0.3);
  EXPECT_DOUBLE_EQ(rig.nearest_m, 3.0);
  EXPECT_DOUBLE_EQ(rig.ground_to_m, 25.0);
  EXPECT_DOUBLE_EQ(rig.obstacles_to_m, 20.0);
  EXPECT_DOUBLE_EQ(rig.people_to_m, 20.0);
  EXPECT_DOUBLE_EQ(rig.vehicles_to_m, 50.0);
}

TEST(RigCapabilityTest, MoreFramesASecondShowMotionFartherAway) {
  RigAssumptions fast;
  fast.rate_hz = 40.0;
  const auto rig = rigCapability(kCar, fast);
  EXPECT_EQ(rig.rate_hz, 40.0);
  EXPECT_GT(rig.people_to_m, rigCapability(kCar).people_to_m);
  EXPECT_GT(rig.vehicles_to_m, rigCapability(kCar).vehicles_to_m);
  EXPECT_EQ(rig.obstacles_to_m, rigCapability(kCar).obstacles_to_m);
}

TEST(RigCapabilityTest, KittiCamerasWithoutKnownMountingHaveThoseOfTheCar) {
  for (const auto& camera : {cameraOf(1226, 370, 707.09, 0.5371, {0.0, 0.0}),
                             cameraOf(1242, 375, 721.54, 0.5327, {0.0, 0.0})}) {
    const auto rig = rigCapability(camera);
    EXPECT_FALSE(rig.camera_height_known);
    EXPECT_DOUBLE_EQ(rig.nearest_m, 3.0);
    EXPECT_DOUBLE_EQ(rig.ground_to_m, 25.0);
    EXPECT_DOUBLE_EQ(rig.obstacles_to_m, 20.0);
    EXPECT_DOUBLE_EQ(rig.people_to_m, 20.0);
    EXPECT_DOUBLE_EQ(rig.vehicles_to_m, 50.0);
  }
}

TEST(RigCapabilityTest, SmallRigsKeepTheirPromises) {
  const auto robot = rigCapability(kRobot);
  EXPECT_DOUBLE_EQ(robot.min_obstacle_height_m, 0.12);
  EXPECT_LE(robot.obstacles_from_m, 0.5);
  EXPECT_GE(robot.obstacles_to_m, 6.0);
  EXPECT_GE(robot.people_to_m, 7.0);
  const auto small = rigCapability(kSmall);
  EXPECT_DOUBLE_EQ(small.min_obstacle_height_m, 0.12);
  EXPECT_LE(small.obstacles_from_m, 0.4);
  EXPECT_GE(small.obstacles_to_m, 3.0);
  EXPECT_GE(small.people_to_m, 3.5);
}

TEST(RigCapabilityTest, HigherObstaclesAreSeenFartherAndLessNoiseReachesFarther) {
  RigAssumptions high;
  high.min_obstacle_height_m = 0.3;
  EXPECT_GT(rigCapability(kRobot, high).obstacles_to_m, rigCapability(kRobot).obstacles_to_m);
  RigAssumptions precise;
  precise.sigma_disparity_px = 0.2;
  EXPECT_GT(rigCapability(kSmall, precise).people_to_m, rigCapability(kSmall).people_to_m);
}

TEST(RigCapabilityTest, LowObstaclesAreSeenWhereTheyStandOutAndHighOnesToTheReach) {
  const auto rig = rigCapability(kRobot);
  EXPECT_EQ(rig.low_obstacle_height_m, 0.08);
  EXPECT_NEAR(rig.low_obstacles_to_m, rig.obstacles_to_m * 0.08 / 0.12, 0.25);
  EXPECT_EQ(rig.obstacleHeight(1.0), 0.08);
  EXPECT_NEAR(rig.obstacleHeight(1.25 * rig.low_obstacles_to_m), 0.1, 1e-9);
  EXPECT_EQ(rig.obstacleHeight(2.0 * rig.obstacles_to_m), 0.12);

  RigAssumptions far;
  far.obstacles_to_m = 20.0;
  EXPECT_EQ(rigCapability(kRobot, far).obstacleHeight(6.5), rig.obstacleHeight(6.5))
      << "a longer reach shows nothing lower";
  RigAssumptions stated;
  stated.min_obstacle_height_m = 0.12;
  EXPECT_EQ(rigCapability(kRobot, stated).obstacleHeight(1.0), 0.12) << "its wheels pass that";
  EXPECT_EQ(rigCapability(kCar).obstacleHeight(5.0), 0.3);
}

TEST(RigCapabilityTest, TheDepthErrorGrowsWithTheSquareOfTheDepth) {
  const auto rig = rigCapability(kRobot);
  EXPECT_NEAR(rig.depthSigma(6.0), 0.4 * 36.0 / 84.0, 1e-12);
}

TEST(RigCapabilityTest, ACameraThatLooksUpIsLimitedByTheDisparitiesAlone) {
  const auto rig = rigCapability(cameraOf(1280, 720, 700.0, 0.12, {0.5, -60.0}));
  EXPECT_NEAR(rig.nearest_m, 84.0 / 256.0, 0.05);
}

TEST(RigCapabilityTest, IsDescribedInOneLine) {
  EXPECT_EQ(
      describe(rigCapability(kSmall)),
      "rig: baseline 0.05 m, camera 0.30 m above the ground, matched from 0.3 m; obstacles "
      "of 0.12 m at 0.3 to 3.0 m, of 0.08 m to 2.0 m; people who walk: 97 % found to 3.0 m, 80 % "
      "from there to 4.0 m; who stand: 83 % to 2.6 m; vehicles' motion to 12 m");
  EXPECT_THAT(describe(rigCapability(cameraOf(640, 480, 450.0, 0.05, {0.0, 0.0}))),
              testing::AllOf(testing::HasSubstr(
                                 "1.65 m above the ground (assumed: no promise of free ground)"),
                             testing::HasSubstr("; people's motion to 5.0 m; vehicles'")))
      << "what is found was not measured with cars";
}

TEST(RigCapabilityTest, WithoutAMountingHeightTheReachOfObstaclesFollowsFromDisparities) {
  const auto drone = rigCapability(cameraOf(752, 480, 458.0, 0.11, {0.0, 0.0}));
  EXPECT_FALSE(drone.camera_height_known);
  EXPECT_DOUBLE_EQ(drone.obstacles_to_m, 7.5);
}

TEST(RigCapabilityTest, ARobotSeesHighObstaclesFartherThanLowOnesAndMeetsDrops) {
  const auto robot = rigCapability(kRobot);
  EXPECT_DOUBLE_EQ(robot.high_obstacles_to_m, 9.5);
  EXPECT_GT(robot.high_obstacles_to_m, robot.obstacles_to_m);
  EXPECT_TRUE(robot.meets_drops);
  EXPECT_FALSE(rigCapability(kCar).meets_drops);
}

TEST(RigCapabilityTest, ConfiguredValuesReplaceDerivedOnes) {
  const auto derived = rigCapability(kRobot);
  EXPECT_DOUBLE_EQ(derived.segments_to_m, 1.5 * derived.people_to_m);
  EXPECT_DOUBLE_EQ(derived.grid_spacing_m, derived.obstacles_to_m / 20.0);
  RigAssumptions configured;
  configured.nearest_m = 0.7;
  configured.obstacles_to_m = 4.1;
  configured.vehicles_to_m = 33.0;
  configured.segments_to_m = 8.0;
  configured.grid_spacing_m = 0.5;
  const auto rig = rigCapability(kRobot, configured);
  EXPECT_EQ(rig.nearest_m, 0.7);
  EXPECT_GE(rig.obstacles_from_m, 0.7);
  EXPECT_EQ(rig.obstacles_to_m, 4.1);
  EXPECT_EQ(rig.vehicles_to_m, 33.0);
  EXPECT_EQ(rig.segments_to_m, 8.0);
  EXPECT_EQ(rig.grid_spacing_m, 0.5);
}

TEST(RigCapabilityTest, NothingReachesBeyondWhatADepthCameraMeasures) {
  StereoCamera camera = kRobot;
  camera.depth_reach_m = 4.0;
  RigAssumptions configured;
  configured.obstacles_to_m = configured.vehicles_to_m = configured.segments_to_m =
      configured.dense_to_m = 9.0;
  for (const auto& rig : {rigCapability(camera), rigCapability(camera, configured)}) {
    EXPECT_LE(rig.ground_to_m, 4.0);
    EXPECT_LE(rig.obstacles_to_m, 4.0);
    EXPECT_LE(rig.high_obstacles_to_m, 4.0);
    EXPECT_LE(rig.people_to_m, 4.0);
    EXPECT_LE(rig.vehicles_to_m, 4.0);
    EXPECT_LE(rig.segments_to_m, 4.0);
    EXPECT_LE(rig.dense_to_m, 4.0);
  }
  EXPECT_EQ(4.0, rigCapability(camera, configured).obstacles_to_m);
}

/// The table of doc/rigs.md.
std::string table() {
  std::string text =
      "| baseline | image | focal length | camera height | matched from | obstacles | people's "
      "motion to | vehicles' to |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const double baseline : {0.05, 0.12, 0.25, 0.54}) {
    for (const auto& like : {kSmall, kRobot, kCar}) {
      auto camera = like;
      camera.baseline_m = baseline;
      const auto rig = rigCapability(camera);
      char row[240];
      std::snprintf(row, sizeof row, "| %.2f m | %d×%d | %.0f px | %.2f m | %.1f m | ", baseline,
                    camera.width, camera.height, camera.fx, rig.camera_height_m, rig.nearest_m);
      text += row;
      std::snprintf(row, sizeof row, "%.2f m: ", rig.min_obstacle_height_m);
      text += row;
      std::snprintf(row, sizeof row, "%.1f to %.1f m", rig.obstacles_from_m, rig.obstacles_to_m);
      text += rig.obstacles_from_m < rig.obstacles_to_m ? row : "none";
      std::snprintf(row, sizeof row, " | %.1f m | %.0f m |\n", rig.people_to_m, rig.vehicles_to_m);
      text += row;
    }
  }
  return text;
}

TEST(RigCapabilityTest, TheTableInTheDocumentationIsComputedByThisCode) {
  std::ifstream file(HEADWAY_SOURCE_DIR "/doc/rigs.md");
  std::stringstream page;
  page << file.rdbuf();
  EXPECT_NE(page.str().find(table()), std::string::npos) << "expected in doc/rigs.md:\n" << table();
}

}  // namespace
}  // namespace headway::stereo
