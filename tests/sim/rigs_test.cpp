// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <headway/sim/rigs.h>
#include <headway/sim/simulator.h>
#include <headway_test/input_error.h>

#include <cmath>

namespace headway::sim {
namespace {

TEST(RigsTest, TheCarIsTheDefault) {
  CameraParams camera;
  camera.focal_px = 1.0;
  applyRig("car", camera);
  const CameraParams standard;
  EXPECT_EQ(camera.width, standard.width);
  EXPECT_EQ(camera.focal_px, standard.focal_px);
  EXPECT_EQ(camera.baseline_m, standard.baseline_m);
  EXPECT_EQ(camera.pitch_down_deg, 0.0);
}

TEST(RigsTest, EveryRigIsWithinTheKeysRanges) {
  for (const std::string& name : rigNames()) {
    CameraParams camera;
    applyRig(name, camera);
    EXPECT_NO_THROW(camera.validate()) << name;
  }
}

TEST(RigsTest, OtherSettingsStay) {
  CameraParams camera;
  camera.imu = true;
  camera.blur_samples = 3;
  applyRig("robot", camera);
  EXPECT_TRUE(camera.imu);
  EXPECT_EQ(camera.blur_samples, 3);
}

TEST(RigsTest, AnUnknownNameIsAnErrorThatListsTheKnown) {
  CameraParams camera;
  EXPECT_THAT([&] { applyRig("drone", camera); },
              ::testing::ThrowsMessage<InputError>(::testing::AllOf(
                  ::testing::HasSubstr("drone"), ::testing::HasSubstr("car, robot, small, rgbd"))));
}

TEST(RigsTest, ThePitchIsInTheMountingAndInThePicture) {
  SimParams params;
  applyRig("robot", params.camera);
  params.camera.width = 320;
  params.camera.height = 180;
  params.camera.focal_px = 175;
  params.camera.ride_deg = 0.0;
  params.traffic.vehicles = params.traffic.cyclists = params.traffic.pedestrians = 0;
  params.world.parked_ratio = 0.0;
  params.recording.frames = 1;
  Simulator simulator(params);
  const StereoCamera camera = simulator.camera();
  const Eigen::Vector3d axis = camera.T_robot_cam.linear().col(2);
  EXPECT_NEAR(std::atan2(-axis.z(), axis.x()), 10.0 * M_PI / 180.0, 1e-9);
  const auto frame = simulator.next();
  ASSERT_TRUE(frame);
  for (int v = 100; v < 180; v += 10) {  // the road lies where the mounting says
    const Eigen::Vector3d ray_robot =
        camera.T_robot_cam.linear() * ray(Eigen::Vector2d(160, v), camera);
    const double z = -camera.T_robot_cam.translation().z() / ray_robot.z();
    EXPECT_NEAR(frame->depth.at<float>(v, 160), z, 1e-3 * z) << "row " << v;
  }
}

}  // namespace
}  // namespace headway::sim
