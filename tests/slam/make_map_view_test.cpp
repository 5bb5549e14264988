// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "map_archive.h"

namespace headway::slam {
namespace {

/// A camera 2 m before its robot's centre, looking ahead.
Pose robotFromCamera() {
  Pose T_robot_cam = robotFromOptical();
  T_robot_cam.translation().x() = 2.0;
  return T_robot_cam;
}

TEST(MakeMapViewTest, KeyframesAreWhereTheRobotWas) {
  Pose T_map_robot = Pose::Identity();
  T_map_robot.translation() << 5.0, 1.0, 0.0;
  T_map_robot.linear() = expSo3({0.0, 0.0, 0.7});
  SparseMap map;
  Keyframe& keyframe = map.addKeyframe(3, 0.5, T_map_robot * robotFromCamera());
  keyframe.covariance(4, 4) = 0.01;  // the camera's yaw: about its y axis
  const MapView view = makeMapView(map, robotFromCamera().inverse(), 0);
  ASSERT_EQ(view.keyframes.size(), 1U);
  EXPECT_EQ(view.keyframes[0].frame, 3U);
  EXPECT_TRUE(view.keyframes[0].T_map_robot.isApprox(T_map_robot, 1e-12));
  EXPECT_NEAR(view.keyframes[0].covariance(5, 5), 0.01, 1e-12) << "the robot's yaw: about z";
  EXPECT_NEAR(view.keyframes[0].covariance(1, 1), 0.04, 1e-12) << "0.1 rad at 2 m";
}

TEST(MakeMapViewTest, LandmarksHaveTheirGreyValueAndTheirObservers) {
  SparseMap map;
  const KeyframeId a = map.addKeyframe(0, 0.0, Pose::Identity()).id;
  const KeyframeId b = map.addKeyframe(1, 0.1, Pose::Identity()).id;
  Landmark& landmark = map.addLandmark({1.0, 2.0, 9.0}, a, {});
  stereo::ReferencePatch patch;
  patch.centre << 4.4F, 7.0F;
  patch.pixels[7 * stereo::ReferencePatch::kSize + 4] = 77;
  landmark.patch = std::make_shared<stereo::ReferencePatch>(patch);
  map.observe(b, landmark.id, {});
  const MapView view = makeMapView(map, Pose::Identity(), 0);
  ASSERT_EQ(view.landmarks.size(), 1U);
  EXPECT_EQ(view.landmarks[0].position, Eigen::Vector3d(1.0, 2.0, 9.0));
  EXPECT_EQ(view.landmarks[0].observations, 2);
  EXPECT_EQ(view.landmarks[0].intensity, 77);
  EXPECT_EQ(view.keyframes[1].landmarks, std::vector<LandmarkId>{landmark.id});
}

/// 200 keyframes with a landmark each.
SparseMap longMap() {
  SparseMap map;
  for (int i = 0; i < 200; ++i) {
    Pose pose = Pose::Identity();
    pose.translation().z() = i;
    map.addLandmark({0.0, 0.0, i + 5.0}, map.addKeyframe(i, 0.1 * i, pose).id, {});
  }
  return map;
}

TEST(MapViewMakerTest, SharesWhatDidNotChange) {
  SparseMap map = longMap();
  MapViewMaker maker(Pose::Identity());
  const MapView before = maker.make(map, 0);
  map.findToChange(LandmarkId{190})->position.x() = 1.0;
  map.keyframeToChange(KeyframeId{0}).T_map_cam.translation().x() = 2.0;
  const MapView after = maker.make(map, 0);
  EXPECT_EQ(&after.landmarks[10], &before.landmarks[10]);
  EXPECT_EQ(&after.keyframes[199], &before.keyframes[199]);
  EXPECT_EQ(before.landmarks[190].position.x(), 0.0);
  EXPECT_EQ(after.landmarks[190].position.x(), 1.0);
  EXPECT_EQ(after.keyframes[0].T_map_robot.translation().x(), 2.0);
}

TEST(MapViewMakerTest, FollowsEveryChangeOfTheMap) {
  SparseMap map = longMap();
  MapViewMaker maker(Pose::Identity());
  const auto expectAsMadeAnew = [&](const char* after) {
    const MapView view = maker.make(map, 0);
    ASSERT_EQ(view.landmarks.size(), map.landmarks().size()) << after;
    ASSERT_EQ(view.keyframes.size(), map.keyframes().size()) << after;
    auto landmark = view.landmarks.begin();
    for (const auto& [id, expected] : map.landmarks()) {
      EXPECT_EQ(landmark->id, id) << after;
      EXPECT_EQ(landmark->observations, static_cast<int>(expected.observations.size())) << after;
      ++landmark;
    }
    auto keyframe = view.keyframes.begin();
    for (const auto& [id, expected] : map.keyframes()) {
      EXPECT_EQ(keyframe->id, id) << after;
      EXPECT_EQ(keyframe->landmarks, expected.landmarks) << after;
      ++keyframe;
    }
  };
  expectAsMadeAnew("nothing");
  map.observe(KeyframeId{70}, LandmarkId{3}, {});
  expectAsMadeAnew("an observation");
  map.removeObservation(KeyframeId{70}, LandmarkId{3});
  expectAsMadeAnew("its removal");
  for (int i = 64; i < 128; ++i) map.removeLandmark(LandmarkId{i});
  expectAsMadeAnew("the removal of a whole group");
  map.removeKeyframe(KeyframeId{5});
  expectAsMadeAnew("the removal of a keyframe");
  map.addKeyframe(200, 20.0, Pose::Identity());
  expectAsMadeAnew("a new keyframe");
  maker.reset();
  map = longMap();
  expectAsMadeAnew("another map");
}

}  // namespace
}  // namespace headway::slam
