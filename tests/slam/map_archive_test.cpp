// SPDX-License-Identifier: BSD-3-Clause
#include "map_archive.h"

#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/slam/stereo_slam.h>
#include <headway_test/textured_world.h>

#include <cmath>
#include <random>

namespace headway::slam {
namespace {

SparseMap smallMap() {
  SparseMap map;
  Pose pose = Pose::Identity();
  pose.translation() << 1.0, -2.0, 0.5;
  const KeyframeId a = map.addKeyframe(3, 1.5, Pose::Identity()).id;
  const KeyframeId b = map.addKeyframe(9, 2.5, pose).id;
  Landmark& landmark = map.addLandmark({1.0, 2.0, 9.0}, a, {{10.5, 20.25}, 7.5, true, 0.5, 0.4});
  stereo::ReferencePatch patch;
  patch.pixels[5] = 77;
  patch.centre << 15.5F, 15.25F;
  landmark.patch = std::make_shared<stereo::ReferencePatch>(patch);
  landmark.descriptor[31] = 200;
  landmark.agreed = 4;
  map.observe(b, landmark.id, {{11.5, 21.25}, 8.5, false, 0.5, 0.4});
  map.setDisparityOffset(-0.125);
  map.setRightTurn({0.001, -0.002, 0.0005});
  return map;
}

TEST(MapArchiveTest, GivesBackWhatItTook) {
  const auto camera = test::smallCamera();
  const std::string bytes = packMap(smallMap(), camera);
  const SparseMap map = unpackMap(bytes, camera);
  EXPECT_EQ(packMap(map, camera), bytes);
  EXPECT_EQ(map.keyframes().size(), 2U);
  EXPECT_EQ(map.keyframe(KeyframeId{1}).landmarks.size(), 1U);
  EXPECT_DOUBLE_EQ(map.disparityOffset(), -0.125);
  EXPECT_EQ(map.rightTurn(), Eigen::Vector3d(0.001, -0.002, 0.0005));
}

TEST(MapArchiveTest, GoesOnWithNewIds) {
  const auto camera = test::smallCamera();
  SparseMap map = unpackMap(packMap(smallMap(), camera), camera);
  EXPECT_EQ(map.addKeyframe(10, 3.0, Pose::Identity()).id, KeyframeId{2});
}

TEST(MapArchiveTest, RefusesToBeCutOffAtAnyByte) {
  const auto camera = test::smallCamera();
  const std::string bytes = packMap(smallMap(), camera);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_THROW(static_cast<void>(unpackMap(bytes.substr(0, length), camera)), InputError);
  }
  EXPECT_THROW(static_cast<void>(unpackMap(bytes + "x", camera)), InputError);
}

TEST(MapArchiveTest, NeverCrashesOnADamagedByte) {
  const auto camera = test::smallCamera();
  const std::string bytes = packMap(smallMap(), camera);
  int refused = 0;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(~damaged[at]);
    try {
      static_cast<void>(unpackMap(damaged, camera));
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 50);
}

/// A map of two keyframes as earlier versions wrote it.
std::string ofVersion(char version, std::string bytes) {
  constexpr std::size_t kTurn = 4 + 4 + 2 * 4 + 5 * 8 + 8;  // follows the offset of the disparities
  constexpr std::size_t kKeyframes = kTurn + 3 * 8 + 8;     // and their number
  constexpr std::size_t kSubmap = 3 * 8 + 16 * 8 + 36 * 8;  // in a keyframe, at its end
  for (const std::size_t before : {std::size_t(1), std::size_t(0)}) {
    bytes.erase(kKeyframes + before * (kSubmap + 4) + kSubmap, sizeof(std::int32_t));
  }
  if (version < 3) bytes.erase(kTurn, 3 * sizeof(double));
  bytes[4] = version;
  return bytes;
}

TEST(MapArchiveTest, ReadsMapsFromBeforeTheRightCamerasTurn) {
  const auto camera = test::smallCamera();
  const SparseMap map = unpackMap(ofVersion(2, packMap(smallMap(), camera)), camera);
  EXPECT_EQ(map.landmarks().size(), 1U);
  EXPECT_DOUBLE_EQ(map.disparityOffset(), -0.125);
  EXPECT_TRUE(map.rightTurn().isZero());
}

TEST(MapArchiveTest, ReadsMapsFromBeforeSubmapsAsASingleOne) {
  const auto camera = test::smallCamera();
  SparseMap written = smallMap();
  written.keyframeToChange(KeyframeId{1}).submap = 3;
  const SparseMap map = unpackMap(ofVersion(3, packMap(written, camera)), camera);
  EXPECT_EQ(map.submaps(), std::vector<int>{0});
  EXPECT_EQ(map.rightTurn(), Eigen::Vector3d(0.001, -0.002, 0.0005));
  EXPECT_EQ(packMap(map, camera), packMap(smallMap(), camera));
}

TEST(MapArchiveTest, KeepsSubmapsAndRefusesNegativeOnes) {
  const auto camera = test::smallCamera();
  SparseMap written = smallMap();
  written.keyframeToChange(KeyframeId{1}).submap = 3;
  const SparseMap map = unpackMap(packMap(written, camera), camera);
  EXPECT_EQ(map.submaps(), (std::vector<int>{0, 3}));
  EXPECT_EQ(map.newSubmap(), 4);
  written.keyframeToChange(KeyframeId{1}).submap = -1;
  EXPECT_THROW(static_cast<void>(unpackMap(packMap(written, camera), camera)), InputError);
}

TEST(MapArchiveTest, RefusesAnotherCameraOrVersion) {
  auto camera = test::smallCamera();
  std::string bytes = packMap(smallMap(), camera);
  camera.baseline_m *= 1.1;
  EXPECT_THROW(static_cast<void>(unpackMap(bytes, camera)), InputError);
  bytes[4] = 99;
  EXPECT_THROW(static_cast<void>(unpackMap(bytes, test::smallCamera())), InputError);
}

/// A hall that a robot walks through.
class SavedHallTest : public testing::Test {
 protected:
  static constexpr int kFrames = 30;

  static test::TexturedWorld hall() {
    test::TexturedWorld world(test::smallCamera());
    world.addRoom(12.0, 8.0, 4.0);
    return world;
  }
  /// The map of one walk, shared by the tests, which only load it.
  static const std::string& savedMap() {
    static const std::string saved = [] {
      const auto world = hall();
      StereoSlam slam(world.camera(), SlamParams{});
      for (int i = 0; i < kFrames; ++i) {
        static_cast<void>(slam.process(world.frame(i, 0.1 * i, onPath(i)), {}));
      }
      return slam.save();
    }();
    return saved;
  }
  static Pose onPath(double i) {
    Pose pose = Pose::Identity();
    pose.translation() << 0.05 * i, 0.3 * std::sin(0.05 * i), 0.0;
    pose.linear() = expSo3({0.0, 0.0, 0.5 * std::sin(0.1 * i)});
    return pose;
  }
  test::TexturedWorld world_ = hall();
  const std::string& saved_ = savedMap();
};

/// A camera that is put down 20 times, at random places of the way and a little beside it.
TEST_F(SavedHallTest, RelocalisesACameraThatStartsAgain) {
  constexpr int kStarts = 20;
  constexpr int kFramesAStart = 5;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> on_way(0.0, kFrames - kFramesAStart);
  std::uniform_real_distribution<double> beside(-0.1, 0.1);
  SlamParams params;
  params.mapping = false;
  int found = 0;
  for (int start = 0; start < kStarts; ++start) {
    StereoSlam slam(world_.camera(), params);
    slam.load(saved_);
    const double first = on_way(random);
    const Eigen::Vector3d offset(beside(random), beside(random), beside(random));
    for (int i = 0; i < kFramesAStart; ++i) {
      Pose pose = onPath(first + i);
      pose.translation() += offset;
      const auto update = slam.process(world_.frame(i, 0.1 * i, pose), {});
      if (update.status != TrackingStatus::kTracked) continue;
      ++found;
      EXPECT_LE((update.T_map_robot.translation() - pose.translation()).norm(), 0.1) << start;
      // What the calibration leaves unknown since the map's origin: an offset of 0.07 px.
      const Eigen::Matrix3d of_place = update.covariance.topLeftCorner<3, 3>();
      EXPECT_GT(std::sqrt(of_place.trace()), 0.03 * update.T_map_robot.translation().norm());
      break;
    }
  }
  EXPECT_GE(found, kStarts - 1);
}

TEST_F(SavedHallTest, IsNotTakenForAnotherWorld) {
  for (const int seed : {55, 56, 57}) {
    test::TexturedWorld other(test::smallCamera(), seed);
    other.addRoom(9.0, 7.0, 3.0);
    StereoSlam slam(world_.camera(), SlamParams{});
    slam.load(saved_);
    for (int i = 0; i < 5; ++i) {
      const auto frame = other.frame(i, 0.1 * i, onPath(6 * i));
      EXPECT_EQ(slam.process(frame, {}).status, TrackingStatus::kLost) << seed << ": " << i;
    }
  }
}

/// What is stored in the submap with the map's origin.
void expectUnchanged(const MapView& stored, const StereoSlam& slam) {
  const MapView now = slam.map(0);
  ASSERT_EQ(now.keyframes.size(), stored.keyframes.size());
  for (std::size_t i = 0; i < stored.keyframes.size(); ++i) {
    EXPECT_EQ(now.keyframes[i].T_map_robot.matrix(), stored.keyframes[i].T_map_robot.matrix());
    EXPECT_EQ(now.keyframes[i].landmarks, stored.keyframes[i].landmarks);
  }
  ASSERT_EQ(now.landmarks.size(), stored.landmarks.size());
  for (std::size_t i = 0; i < stored.landmarks.size(); ++i) {
    EXPECT_EQ(now.landmarks[i].id, stored.landmarks[i].id);
    EXPECT_EQ(now.landmarks[i].position, stored.landmarks[i].position);
  }
}

TEST_F(SavedHallTest, StaysAsItIsWhileACameraElsewhereBuildsASubmap) {
  test::TexturedWorld other(test::smallCamera(), 55);
  other.addRoom(9.0, 7.0, 3.0);
  for (const bool mapping : {true, false}) {
    SlamParams params;
    params.restart_after_s = 0.3;
    params.mapping = mapping;
    StereoSlam slam(world_.camera(), params);
    slam.load(saved_);
    const MapView stored = slam.map(0);
    SlamUpdate update;
    for (int i = 0; i < 20; ++i) {
      update = slam.process(other.frame(i, 0.1 * i, onPath(0.5 * i)), {});
      EXPECT_NE(update.status, TrackingStatus::kTracked) << i;
    }
    expectUnchanged(stored, slam);
    EXPECT_EQ(update.status, mapping ? TrackingStatus::kTrackedInNewSubmap : TrackingStatus::kLost);
    EXPECT_EQ(slam.submaps(), mapping ? (std::vector<int>{0, 1}) : (std::vector<int>{0}));
    if (!mapping) continue;
    EXPECT_GE(slam.map().keyframes.size(), 2U);
    const std::string saved = slam.save();
    StereoSlam again(world_.camera(), params);
    again.load(saved);
    EXPECT_EQ(again.submaps(), slam.submaps());
    EXPECT_EQ(again.map(1).landmarks.size(), slam.map(1).landmarks.size());
    EXPECT_EQ(again.save(), saved);
  }
}

TEST_F(SavedHallTest, TheSubmapOfACameraThatIsRecognisedLateIsJoined) {
  SlamParams params;
  params.restart_after_s = 0.1;
  StereoSlam slam(world_.camera(), params);
  slam.load(saved_);
  // It begins with its back to what is stored, and turns.
  SlamUpdate update;
  int joined = 0;
  for (int i = 0; i < 80; ++i) {
    Pose pose = onPath(5.0);
    pose.linear() = expSo3({0.0, 0.0, M_PI - 0.05 * std::min(i, 64)});
    pose.translation().x() += 0.01 * i;
    update = slam.process(world_.frame(i, 0.1 * i, pose), {});
    if (update.revision.cause == MapChange::kSubmapJoined) ++joined;
    if (joined > 0) {
      EXPECT_EQ(update.status, TrackingStatus::kTracked) << i;
      EXPECT_EQ(update.submap, 0);
    } else if (i > 2) {
      EXPECT_EQ(update.status, TrackingStatus::kTrackedInNewSubmap) << i;
      EXPECT_EQ(update.submap, 1);
    }
    if (i == 79) {
      EXPECT_LT((update.T_map_robot.translation() - pose.translation()).norm(), 0.1);
    }
  }
  EXPECT_GE(joined, 1);
  EXPECT_EQ(slam.submaps(), std::vector<int>{0});
}

TEST_F(SavedHallTest, GrowsOnWithMapping) {
  StereoSlam slam(world_.camera(), SlamParams{});
  slam.load(saved_);
  const std::size_t before = slam.map().keyframes.size();
  for (int i = 0; i < 12; ++i) {
    const auto update = slam.process(world_.frame(i, 0.1 * i, onPath(kFrames - 3 + i)), {});
    EXPECT_EQ(update.status, TrackingStatus::kTracked) << i;
  }
  EXPECT_GT(slam.map().keyframes.size(), before);
}

}  // namespace
}  // namespace headway::slam
