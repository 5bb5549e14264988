// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/slam/stereo_slam.h>
#include <headway_test/textured_world.h>

#include "local_mapper.h"

namespace headway::slam {
namespace {

constexpr int kWindow = 3;

/// Keyframes in a row, one a metre, that look at a wall of landmarks.
class CullingTest : public testing::Test {
 protected:
  KeyframeId addKeyframe(double x) {
    Pose pose = Pose::Identity();
    pose.translation().x() = x;
    return map_.addKeyframe(0, 0.0, pose).id;
  }
  LandmarkId addLandmark(KeyframeId reference, const std::vector<KeyframeId>& others) {
    const LandmarkId id = map_.addLandmark({0.0, 0.0, 10.0}, reference, {}).id;
    for (const KeyframeId other : others) map_.observe(other, id, {});
    return id;
  }
  /// Keyframes that all see the same landmarks from the same place.
  std::vector<KeyframeId> addCrowd(int count) {
    std::vector<KeyframeId> crowd;
    for (int i = 0; i < count; ++i) crowd.push_back(addKeyframe(0.0));
    for (int i = 0; i < 20; ++i) {
      addLandmark(crowd.front(), {crowd.begin() + 1, crowd.end()});
    }
    return crowd;
  }
  SparseMap map_;
};

TEST_F(CullingTest, ALandmarkThatOnlyOnePassedKeyframeSawIsRemoved) {
  const auto crowd = addCrowd(6);
  const LandmarkId passed = addLandmark(crowd[1], {});
  const LandmarkId shared = addLandmark(crowd[1], {crowd[2]});
  const LandmarkId fresh = addLandmark(crowd[4], {});
  cullLandmarks(crowd.back(), kWindow, map_);
  EXPECT_EQ(map_.find(passed), nullptr);
  EXPECT_NE(map_.find(shared), nullptr);
  EXPECT_NE(map_.find(fresh), nullptr) << "it may still be seen again";
}

TEST_F(CullingTest, ALandmarkLookedForInVainIsRemoved) {
  const auto crowd = addCrowd(2);
  Landmark& vain = *map_.findToChange(addLandmark(crowd[0], {crowd[1]}));
  const LandmarkId id = vain.id;
  vain.tried = 8;
  vain.found = 1;
  cullLandmarks(crowd.back(), kWindow, map_);
  EXPECT_EQ(map_.find(id), nullptr);
}

TEST_F(CullingTest, AKeyframeThatOthersMakeSuperfluousIsFound) {
  const auto crowd = addCrowd(6);
  EXPECT_EQ(redundantKeyframe(crowd.back(), kWindow, map_), crowd[1]);
}

TEST_F(CullingTest, TheFirstAndTheNewestKeyframesStay) {
  const auto crowd = addCrowd(kWindow + 1);
  EXPECT_EQ(redundantKeyframe(crowd.back(), kWindow, map_), std::nullopt);
}

TEST_F(CullingTest, AKeyframeWithLandmarksOfItsOwnStays) {
  const auto crowd = addCrowd(5);
  for (int i = 0; i < 4; ++i) addLandmark(crowd[1], {crowd[2]});
  EXPECT_EQ(redundantKeyframe(crowd.back(), kWindow, map_), std::nullopt);
}

TEST_F(CullingTest, AKeyframeThatObservesLandmarksFromNearestStays) {
  const auto crowd = addCrowd(5);
  map_.keyframeToChange(crowd[1]).T_map_cam.translation().z() = 6.0;
  EXPECT_EQ(redundantKeyframe(crowd.back(), kWindow, map_), std::nullopt);
}

TEST_F(CullingTest, TheReplacementKeyframeSharesMostLandmarks) {
  const KeyframeId first = addKeyframe(0.0);
  const KeyframeId other = addKeyframe(1.0);
  const KeyframeId leaving = addKeyframe(2.0);
  EXPECT_EQ(replacementKeyframe(leaving, map_), first) << "no keyframe shares any landmark";
  addLandmark(leaving, {other});
  EXPECT_EQ(replacementKeyframe(leaving, map_), other);
}

TEST_F(CullingTest, LandmarksOfARemovedKeyframeKeepTheirAppearance) {
  const KeyframeId a = addKeyframe(0.0);
  const KeyframeId b = addKeyframe(1.0);
  const KeyframeId c = addKeyframe(3.0);
  const LandmarkId id = addLandmark(a, {b, c});
  map_.removeKeyframe(a);
  ASSERT_NE(map_.find(id), nullptr);
  EXPECT_EQ(map_.find(id)->reference, b) << "the nearest";
  const auto cutFrom = [&] {
    const Landmark& landmark = *map_.find(id);
    const Pose T_map_cut =
        map_.keyframe(landmark.reference).T_map_cam * landmark.T_reference_cut.cast<double>();
    return Eigen::Vector3d(T_map_cut.translation());
  };
  EXPECT_LT(cutFrom().norm(), 1e-6);
  map_.removeKeyframe(b);
  EXPECT_EQ(map_.find(id)->reference, c);
  EXPECT_LT(cutFrom().norm(), 1e-6);
  map_.removeKeyframe(c);
  EXPECT_EQ(map_.find(id), nullptr);
}

/// A place that is passed again and again, a little differently each time.
TEST(StereoSlamTest, TheMapOfAPlaceDoesNotGrowWithTime) {
  constexpr int kFramesOfLap = 40;
  constexpr int kLaps = 7;
  test::TexturedWorld world(test::smallCamera());
  world.addRoom(12.0, 8.0, 4.0);
  const auto pose = [](int i, int lap) {  // there and back
    const double along = 0.5 - 0.5 * std::cos(2.0 * M_PI * i / kFramesOfLap);
    Pose T_map_robot = Pose::Identity();
    T_map_robot.translation() << 2.0 * along, 0.04 * (lap % 2) * std::sin(0.4 * i), 0.0;
    T_map_robot.linear() = expSo3({0.0, 0.0, 0.6 * along});
    return T_map_robot;
  };
  std::vector<StereoFrame> frames;
  for (int i = 0; i < 2 * kFramesOfLap; ++i)
    frames.push_back(world.frame(0, 0.0, pose(i, i / kFramesOfLap)));

  SlamParams params;
  params.features = 200;
  StereoSlam slam(world.camera(), params);
  params.trajectory_in_memory = 5;
  StereoSlam small(world.camera(), params);
  std::vector<std::size_t> keyframes, bytes;
  for (int i = 0; i < kLaps * kFramesOfLap; ++i) {
    StereoFrame frame = frames[static_cast<std::size_t>(i % (2 * kFramesOfLap))];
    frame.index = static_cast<std::size_t>(i);
    frame.time = 0.1 * i;
    const auto update = slam.process(frame, {});
    ASSERT_EQ(update.status, TrackingStatus::kTracked) << i;
    (void)small.process(frame, {});
    const Pose truth = pose(i % (2 * kFramesOfLap), i / kFramesOfLap);
    EXPECT_LT((update.T_map_robot.translation() - truth.translation()).norm(), 0.03) << i;
    if ((i + 1) % kFramesOfLap != 0) continue;
    keyframes.push_back(slam.map().keyframes.size());
    bytes.push_back(slam.save().size());
  }
  EXPECT_LE(keyframes[6], keyframes[2] + 2);
  EXPECT_LT(static_cast<double>(bytes[6]), 1.25 * static_cast<double>(bytes[2]));
  ASSERT_EQ(slam.trajectory().size(), static_cast<std::size_t>(kLaps * kFramesOfLap));
  for (const auto& estimate : slam.trajectory()) {  // also those whose keyframe was removed
    const int i = static_cast<int>(estimate.frame);
    const Pose truth = pose(i % (2 * kFramesOfLap), i / kFramesOfLap);
    EXPECT_LT((estimate.T_map_robot.translation() - truth.translation()).norm(), 0.03) << i;
  }
  const auto in_memory = slam.trajectory();
  const auto in_file = small.trajectory();
  ASSERT_EQ(in_memory.size(), in_file.size());
  for (std::size_t i = 0; i < in_memory.size(); ++i) {
    EXPECT_EQ(in_memory[i].frame, in_file[i].frame);
    EXPECT_EQ(in_memory[i].T_map_robot.matrix(), in_file[i].T_map_robot.matrix()) << i;
  }
}

}  // namespace
}  // namespace headway::slam
