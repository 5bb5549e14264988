// SPDX-License-Identifier: BSD-3-Clause
#include "view.h"

#include <gtest/gtest.h>

#include "example_street.h"

namespace headway::scene {
namespace {

SnapshotInput inputAt(const map::PerceptionMap& map, double z) {
  SnapshotInput input{map, 0, 0.0};
  input.T_map_robot.translation().z() = z;
  return input;
}

TEST(GroundHeightTest, IsTheLowerFaceOfBoxes) {
  map::PerceptionMap map = streetMap();
  EXPECT_NEAR(groundHeight(inputAt(map, 5.0)), 0.0, 1e-9);
}

TEST(GroundHeightTest, IsALowPercentileOfLandmarksWithFewBoxes) {
  std::vector<slam::LandmarkView> landmarks;
  for (int i = 0; i < 200; ++i) {
    landmarks.push_back({LandmarkId{i}, {0.1 * i, 1.0, -1.65 + 0.05 * i}, 3, 100});
  }
  map::PerceptionMap map;
  map.update(slam::MapView{landmarks, {}});
  map.update(0.0, {streetTrack(1, ObjectClass::kCar, {5, 5}, 0.0, 0.0)});
  const double ground = groundHeight(inputAt(map, 0.0));
  EXPECT_GT(ground, -1.65);
  EXPECT_LT(ground, -0.5);
}

TEST(GroundHeightTest, UsesOnlyLandmarksAroundTheRobot) {
  std::vector<slam::LandmarkView> landmarks;
  for (int i = 0; i < 200; ++i) {
    landmarks.push_back({LandmarkId{i}, {500.0 + i, 0.0, -30.0}, 3, 100});
  }
  map::PerceptionMap map;
  map.update(slam::MapView{landmarks, {}});
  EXPECT_EQ(groundHeight(inputAt(map, 2.5)), 2.5);
}

TEST(GroundHeightTest, IsTheRobotsHeightInAnEmptyMap) {
  EXPECT_EQ(groundHeight(inputAt(map::PerceptionMap(), 2.5)), 2.5);
}

TEST(CameraViewTest, AgreesWithTheCameraAtImageSize) {
  const auto camera = streetCamera();
  const auto view = cameraView(camera, Pose::Identity(), {camera.width, camera.height});
  const Eigen::Vector3d point(9.0, 2.0, 0.5);
  const auto pixel = render::project(point, view);
  const auto uvd = headway::project(camera.T_robot_cam.inverse() * point, camera);
  ASSERT_TRUE(pixel && uvd);
  EXPECT_TRUE(pixel->isApprox(uvd->head<2>(), 1e-9));
}

TEST(FittedIntoTest, KeepsAspectRatioAndCentre) {
  EXPECT_EQ(fittedInto({640, 240}, {1280, 720}), cv::Rect(0, 120, 1280, 480));
  EXPECT_EQ(fittedInto({640, 480}, {1280, 720}), cv::Rect(160, 0, 960, 720));
}

TEST(CameraViewTest, ScalesWithThePicture) {
  const auto camera = streetCamera();
  const auto whole = cameraView(camera, Pose::Identity(), {camera.width, camera.height});
  const auto half = cameraView(camera, Pose::Identity(), {camera.width / 2, camera.height / 2});
  const auto large = render::project({9.0, 2.0, 0.5}, whole);
  const auto small = render::project({9.0, 2.0, 0.5}, half);
  ASSERT_TRUE(large && small);
  const Eigen::Vector2d pixel_centre(0.5, 0.5);
  EXPECT_TRUE((2.0 * (*small + pixel_centre)).isApprox(*large + pixel_centre, 1e-9));
}

TEST(ExternalViewTest, FollowLooksForwardFromBehindTheRobot) {
  const map::PerceptionMap map;
  SnapshotInput input{map, 0, 0.0};
  input.T_map_robot = Pose(Eigen::Translation3d(100, 50, 0) *
                           Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitZ()));
  const auto view = externalView({640, 360, View::kFollow}, input, 0.0);
  EXPECT_LT(view.T_map_camera.translation().y(), 50.0) << "behind a robot that faces +y";
  const auto ahead = render::project({100, 60, 0}, view);
  const auto left = render::project({95, 60, 0}, view);
  ASSERT_TRUE(ahead && left);
  EXPECT_NEAR(ahead->x(), 319.5, 1e-6);
  EXPECT_LT(left->x(), ahead->x());
}

TEST(ExternalViewTest, TopShowsTheHeadingUpwards) {
  const map::PerceptionMap map;
  SnapshotInput input{map, 0, 0.0};
  input.T_map_robot = Pose(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()));
  const auto view = externalView({640, 360, View::kTop}, input, 0.0);
  const auto robot = render::project(Eigen::Vector3d::Zero(), view);
  const auto ahead = render::project(input.T_map_robot * Eigen::Vector3d(10, 0, 0), view);
  ASSERT_TRUE(robot && ahead);
  EXPECT_NEAR(ahead->x(), robot->x(), 1e-6);
  EXPECT_LT(ahead->y(), robot->y());
}

TEST(ExternalViewTest, OrbitReturnsAfter360Frames) {
  const map::PerceptionMap map;
  SnapshotInput input{map, 20, 0.0};
  const SnapshotOptions options{640, 360, View::kOrbit};
  const auto eyeAt = [&](std::size_t frame) {
    input.frame = frame;
    return Eigen::Vector3d(externalView(options, input, 0.0).T_map_camera.translation());
  };
  EXPECT_TRUE(eyeAt(20).isApprox(eyeAt(380), 1e-9));
  EXPECT_GT((eyeAt(20) - eyeAt(200)).norm(), 70.0) << "opposite after half a revolution";
}

TEST(SceneScaleTest, FollowsTheReachOfTheRig) {
  const map::PerceptionMap map;
  SnapshotInput input{map, 0, 0.0};
  EXPECT_EQ(sceneScale(input), 1.0) << "without a camera";
  StereoCamera car;
  car.width = 1241;
  car.height = 376;
  car.fx = car.fy = 707.0;
  car.cx = 620.0;
  car.cy = 188.0;
  car.baseline_m = 0.54;
  car.T_robot_cam.translation().z() = 1.65;
  input.camera = std::make_shared<const StereoCamera>(car);
  EXPECT_EQ(sceneScale(input), 1.0);
  StereoCamera small = car;
  small.baseline_m = 0.05;
  small.T_robot_cam.translation().z() = 0.3;
  input.camera = std::make_shared<const StereoCamera>(small);
  const double scale = sceneScale(input);
  EXPECT_GE(scale, 0.2);
  EXPECT_LT(scale, 0.4);
  SnapshotOptions options;
  options.view = View::kTop;
  EXPECT_NEAR(externalView(options, input, 0.0).T_map_camera.translation().z(), 95.0 * scale, 1e-6);
}

TEST(SceneScaleTest, GridLinesHaveRoundSpacings) {
  EXPECT_DOUBLE_EQ(gridSpacing(1.0), 10.0);
  EXPECT_DOUBLE_EQ(gridSpacing(0.99), 5.0);
  EXPECT_DOUBLE_EQ(gridSpacing(0.33), 2.0);
  EXPECT_DOUBLE_EQ(gridSpacing(0.28), 2.0);
}

TEST(FrustumEdgesTest, StartAtTheCameraAndEndInItsImageCorners) {
  const auto camera = streetCamera();
  const Pose T_map_robot(Eigen::Translation3d(3, 4, 0.5));
  const auto edges = frustumEdges(camera, T_map_robot, 0.5);
  const Pose T_cam_map = (T_map_robot * camera.T_robot_cam).inverse();
  for (std::size_t i = 4; i < 8; ++i) {
    EXPECT_LT((T_cam_map * edges[i].first).norm(), 1e-9);
    const Eigen::Vector3d corner = T_cam_map * edges[i].second;
    EXPECT_NEAR(corner.z(), 0.9, 1e-9);
    const auto pixel = headway::project(corner, camera);
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(std::min(pixel->x(), camera.width - pixel->x()), 0.0, 1e-6);
    EXPECT_NEAR(std::min(pixel->y(), camera.height - pixel->y()), 0.0, 1e-6);
  }
}

}  // namespace
}  // namespace headway::scene
