// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/pipeline/moving_regions.h>

#include <cmath>
#include <limits>
#include <optional>

namespace headway::pipeline {
namespace {

const StereoCamera kCamera{640, 240, 400.0, 400.0, 320.0, 120.0, 0.5, robotFromOptical()};

Detection detectionIn(const Box2d& box) {
  Detection detection;
  detection.box2d = box;
  return detection;
}

Track trackIn(const Box2d& box, TrackStatus status, MotionState motion_state) {
  Track track;
  track.box2d = box;
  track.status = status;
  track.motion_state = motion_state;
  return track;
}

TEST(MovingRegionsTest, TracksClassifyTheBoxes) {
  const Box2d box{100, 50, 200, 150};
  Detections detections;
  detections.items = {detectionIn(box)};
  const auto counts = [&](const std::vector<Track>& previous) {
    const auto regions = movingRegions(detections, previous, kCamera);
    return std::pair(regions.boxes.size(), regions.unsure.size());
  };
  const std::pair<std::size_t, std::size_t> moves(1, 0), stays(0, 0), unsure(0, 1);
  EXPECT_EQ(moves, counts({trackIn(box, TrackStatus::kConfirmed, MotionState::kMoving)}));
  EXPECT_EQ(stays, counts({trackIn(box, TrackStatus::kConfirmed, MotionState::kStatic)}));
  EXPECT_EQ(unsure, counts({}));
  EXPECT_EQ(unsure, counts({trackIn(box, TrackStatus::kTentative, MotionState::kStatic)}));
  EXPECT_EQ(unsure, counts({trackIn(box, TrackStatus::kConfirmed, MotionState::kUnknown)}));
  EXPECT_EQ(unsure,
            counts({trackIn({300, 50, 400, 150}, TrackStatus::kConfirmed, MotionState::kStatic)}));
}

TEST(MovingRegionsTest, TheTrackThatOverlapsMostDecides) {
  const Box2d box{100, 50, 200, 150};
  Detections detections;
  detections.items = {detectionIn(box)};
  const auto still = trackIn({140, 50, 240, 150}, TrackStatus::kConfirmed, MotionState::kStatic);
  const auto moving = trackIn({105, 50, 205, 150}, TrackStatus::kConfirmed, MotionState::kMoving);
  EXPECT_EQ(1u, movingRegions(detections, {still, moving}, kCamera).boxes.size());
  EXPECT_EQ(1u, movingRegions(detections, {moving, still}, kCamera).boxes.size());
}

TEST(MovingRegionsTest, A3dBoxAloneIsProjected) {
  Detection detection;
  detection.box3d = Box3d{{0, 0, 10}, 4.0, 2.0, 1.5, 0.0};
  Detections detections;
  detections.items = {detection};
  const auto regions = movingRegions(detections, {}, kCamera);
  ASSERT_EQ(1u, regions.unsure.size());
  // Nearest face at z = 9 m: half length 2 m, half height 0.75 m.
  EXPECT_NEAR(320.0 - 400.0 * 2.0 / 9.0, regions.unsure[0].left, 1e-9);
  EXPECT_NEAR(120.0 + 400.0 * 0.75 / 9.0, regions.unsure[0].bottom, 1e-9);
}

TEST(MovingRegionsTest, ABoxThatReachesBehindTheCameraIsCutAtIt) {
  // A van beside the camera, from 1 m behind it to 4 m before it, its near side 0.5 m to the right.
  const Box3d beside{{1.5, 0.0, 1.5}, 5.0, 2.0, 2.0, -M_PI / 2.0};
  const auto box = projectedBox(beside, kCamera);
  ASSERT_TRUE(box);
  EXPECT_NEAR(320.0 + 400.0 * 0.5 / 4.0, box->left, 1e-9) << "its farthest edge";
  EXPECT_EQ(639.0, box->right);
  EXPECT_EQ(0.0, box->top);
  EXPECT_EQ(239.0, box->bottom);
  const auto around = projectedBox({{0.0, 0.0, 0.0}, 2.0, 2.0, 2.0, 0.3}, kCamera);
  ASSERT_TRUE(around) << "the camera is in it";
  EXPECT_EQ(0.0, around->left);
  EXPECT_EQ(639.0, around->right);
  EXPECT_FALSE(projectedBox({{0.0, 0.0, -2.0}, 2.0, 2.0, 2.0, 0.3}, kCamera)) << "all of it behind";
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(projectedBox({{0.0, 0.0, unknown}, 2.0, 2.0, 2.0, 0.3}, kCamera));
}

TEST(MovingRegionsTest, ABoxEndsBehindItsObject) {
  Detection detection = detectionIn({100, 50, 200, 150});
  Detections detections;
  const auto depthOf = [&](const std::optional<Box3d>& box) {
    detection.box3d = box;
    detections.items = {detection};
    return movingRegions(detections, {}, kCamera).unsure.at(0).to_m;
  };
  const double behind = 10.0 + 0.5 * std::hypot(4.0, 2.0);
  EXPECT_GT(depthOf(Box3d{{0, 0, 10}, 4.0, 2.0, 1.5, 0.0}), behind + 0.5);
  EXPECT_LT(depthOf(Box3d{{0, 0, 10}, 4.0, 2.0, 1.5, 0.0}), behind + 2.0);
  EXPECT_EQ(std::numeric_limits<double>::infinity(), depthOf(std::nullopt));
  for (const double z : {std::numeric_limits<double>::quiet_NaN(), -10.0}) {
    EXPECT_EQ(std::numeric_limits<double>::infinity(),
              depthOf(Box3d{{0, 0, z}, 4.0, 2.0, 1.5, 0.0}))
        << "an unknown depth keeps nothing";
  }
}

TEST(MovingRegionsTest, MovingTracksAreAtTheirObservedOrPredictedBoxes) {
  Track track;
  track.motion_state = MotionState::kMoving;
  track.status = TrackStatus::kCoasting;
  track.position << 12.0, 0.0, 0.0;
  track.size << 4.0, 2.0, 1.5;
  Pose robot = Pose::Identity();
  robot.translation().x() = 2.0;
  auto regions = movingRegions(std::vector<Track>{track}, robot, kCamera);
  ASSERT_EQ(1u, regions.boxes.size());
  // Nearest face at z = 8 m: half width 1 m, half height 0.75 m.
  EXPECT_NEAR(320.0 - 400.0 * 1.0 / 8.0, regions.boxes[0].left, 1e-9);
  EXPECT_NEAR(120.0 + 400.0 * 0.75 / 8.0, regions.boxes[0].bottom, 1e-9);

  track.box2d = Box2d{100, 50, 200, 150};
  EXPECT_EQ(2u, movingRegions(std::vector<Track>{track}, robot, kCamera).boxes.size());
  track.position.x() = -12.0;
  EXPECT_EQ(1u, movingRegions(std::vector<Track>{track}, robot, kCamera).boxes.size());
  track.motion_state = MotionState::kStatic;
  EXPECT_TRUE(movingRegions(std::vector<Track>{track}, robot, kCamera).boxes.empty());
}

TEST(MovingRegionsTest, InvalidBoxesAreIgnored) {
  Detection behind;
  behind.box3d = Box3d{{0, 0, -10}, 4.0, 2.0, 1.5, 0.0};
  Detections detections;
  detections.items = {behind, Detection(),
                      detectionIn({std::numeric_limits<double>::quiet_NaN(), 0, 1, 1})};
  const auto regions = movingRegions(detections, {}, kCamera);
  EXPECT_TRUE(regions.boxes.empty() && regions.unsure.empty());
}

TEST(MovableRegionsTest, OnlyVehiclesThatStandStayInTheMap) {
  const Box2d box{100, 50, 200, 150};
  const auto countOf = [&](ObjectClass object_class, MotionState state, TrackStatus status) {
    Track track = trackIn(box, status, state);
    track.object_class = object_class;
    track.position << 500.0, 500.0, 0.0;  // out of view
    return movableRegions({}, {track}, Pose::Identity(), kCamera).boxes.size();
  };
  using C = ObjectClass;
  using M = MotionState;
  EXPECT_EQ(0u, countOf(C::kCar, M::kStatic, TrackStatus::kConfirmed));
  EXPECT_EQ(1u, countOf(C::kCar, M::kUnknown, TrackStatus::kTentative));
  EXPECT_EQ(1u, countOf(C::kPedestrian, M::kStatic, TrackStatus::kConfirmed));
  EXPECT_EQ(1u, countOf(C::kPedestrian, M::kUnknown, TrackStatus::kCoasting));
  EXPECT_EQ(0u, countOf(C::kPedestrian, M::kMoving, TrackStatus::kEnded));
  EXPECT_EQ(1u, countOf(C::kUnknown, M::kStatic, TrackStatus::kConfirmed)) << "as a person";
}

TEST(MovableRegionsTest, BoxesOfDetectionsAreWidened) {
  Detections detections;
  detections.items = {detectionIn({100, 50, 200, 150}), detectionIn({300, 50, 400, 150})};
  detections.items[0].object_class = ObjectClass::kPedestrian;
  detections.items[1].object_class = ObjectClass::kCar;
  const auto regions = movableRegions(detections, {}, Pose::Identity(), kCamera);
  ASSERT_EQ(1u, regions.boxes.size()) << "a car's box may be of a parked one";
  EXPECT_DOUBLE_EQ(87.5, regions.boxes[0].left);
  EXPECT_DOUBLE_EQ(162.5, regions.boxes[0].bottom);
}

}  // namespace
}  // namespace headway::pipeline
