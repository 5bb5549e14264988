// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/pipeline/perception.h>
#include <headway_test/input_error.h>

#include <cmath>
#include <stdexcept>

namespace headway::pipeline {
namespace {

/// A robot driving along x at 5 m/s past one pedestrian who walks along y at 1.5 m/s.
RecordedFrame walkFrame(std::size_t index) {
  RecordedFrame frame;
  frame.index = index;
  frame.time = 0.1 * static_cast<double>(index);
  Pose robot = Pose::Identity();
  robot.translation().x() = 5.0 * frame.time;
  frame.T_map_robot = robot;

  const Eigen::Vector3d person(20.0, -3.0 + 1.5 * frame.time, 0.9);
  Detection detection;
  detection.object_class = ObjectClass::kPedestrian;
  detection.score = 0.9;
  Box3d box;
  box.centre = (robot * robotFromOptical()).inverse() * person;
  box.length = 0.8;
  box.width = 0.6;
  box.height = 1.75;
  box.yaw = opticalYaw(robotFromOptical().linear().transpose() * Eigen::Vector3d::UnitY());
  detection.box3d = box;
  Detections detections;
  detections.time = frame.time;
  detections.items = {detection};
  frame.detections = detections;
  return frame;
}

TEST(PerceptionTest, WithPosesAndNoImagesTheObjectLayerRunsAlone) {
  Perception perception(nullptr, {});
  PerceptionUpdate update;
  for (std::size_t i = 0; i < 25; ++i) update = perception.process(walkFrame(i));
  ASSERT_EQ(1u, update.objects.tracks.size());
  const Track& track = update.objects.tracks.front();
  EXPECT_EQ(TrackStatus::kConfirmed, track.status);
  EXPECT_TRUE(isMoving(track));
  EXPECT_NEAR(20.0, track.position.x(), 0.1);
  EXPECT_NEAR(-3.0 + 1.5 * 2.4, track.position.y(), 0.15);
  EXPECT_NEAR(1.5, track.velocity.y(), 0.2);
  ASSERT_FALSE(track.predictions.empty());
  const auto& last = track.predictions.front().points.back();
  EXPECT_NEAR(3.0, last.horizon_s, 1e-9);
  EXPECT_NEAR(track.position.y() + 4.5, last.position.y(), 0.9);
  EXPECT_EQ(1u, perception.map().movingObjects().tracks().size());
  EXPECT_EQ(25u, perception.trajectory().size());
}

TEST(PerceptionTest, AFrameWithoutPoseIsLostAndItsBoxesAreCounted) {
  Perception perception(nullptr, {});
  for (std::size_t i = 0; i < 10; ++i) (void)perception.process(walkFrame(i));
  auto blind = walkFrame(10);
  blind.T_map_robot.reset();
  const auto update = perception.process(blind);
  EXPECT_EQ(slam::TrackingStatus::kLost, update.camera.status);
  EXPECT_EQ(1u, update.objects.detections_dropped.at("camera_lost"));
  ASSERT_EQ(1u, update.objects.tracks.size());
  EXPECT_EQ(TrackStatus::kCoasting, update.objects.tracks.front().status);
  EXPECT_FALSE(perception.trajectory().back().tracked);
}

TEST(PerceptionTest, AFrameWithTheTimeOfTheOneBeforeEndsNoTrack) {
  Perception perception(nullptr, {});
  PerceptionUpdate update;
  for (std::size_t i = 0; i < 15; ++i) update = perception.process(walkFrame(i));
  ASSERT_EQ(1u, update.objects.tracks.size());
  const Track before = update.objects.tracks.front();
  RecordedFrame repeated = walkFrame(15);
  repeated.time = repeated.detections->time = walkFrame(14).time;
  update = perception.process(repeated);
  ASSERT_EQ(1u, update.findings.size());
  EXPECT_EQ("time_repeated", update.findings[0].name);
  EXPECT_EQ(15u, update.findings[0].frame);
  EXPECT_TRUE(update.findings[0].is_first);
  EXPECT_EQ(1u, update.objects.detections_dropped.at("time_repeated"));
  ASSERT_EQ(1u, update.objects.tracks.size());
  EXPECT_EQ(before.id, update.objects.tracks.front().id);
  EXPECT_TRUE(update.objects.tracks.front().position.isApprox(before.position, 1e-9));
  for (std::size_t i = 16; i < 20; ++i) update = perception.process(walkFrame(i));
  EXPECT_TRUE(update.findings.empty());
  ASSERT_EQ(1u, update.objects.tracks.size());
  EXPECT_EQ(before.id, update.objects.tracks.front().id);
  EXPECT_NEAR(1.5, update.objects.tracks.front().velocity.y(), 0.25);
  EXPECT_EQ(20u, perception.trajectory().size());
  EXPECT_EQ(1u, perception.warnings().at("time_repeated").count);
}

TEST(PerceptionTest, AfterAnExceptionOfACallbackTheNextFrameFollowsTheLastCompletedOne) {
  Perception perception(nullptr, {});
  PerceptionUpdate update;
  for (std::size_t i = 0; i < 15; ++i) update = perception.process(walkFrame(i));
  const TrackId id = update.objects.tracks.at(0).id;
  PerceptionCallbacks callbacks;
  callbacks.on_pose = [](Time, const slam::SlamUpdate&) { throw std::runtime_error("host"); };
  perception.setCallbacks(callbacks);
  EXPECT_THROW((void)perception.process(walkFrame(15)), std::runtime_error);
  perception.setCallbacks({});
  for (std::size_t i = 15; i < 18; ++i) {
    update = perception.process(walkFrame(i));
    EXPECT_TRUE(update.findings.empty()) << i;
  }
  ASSERT_EQ(1u, update.objects.tracks.size());
  EXPECT_EQ(id, update.objects.tracks.front().id);
}

TEST(PerceptionTest, FillsTheLayersThatItIsGiven) {
  map::PerceptionMap given;
  given.update(mrpt::maps::COccupancyGridMap2D::Create(-5.f, 5.f, -5.f, 5.f, 0.5f));
  Perception perception(nullptr, {}, given);
  for (std::size_t i = 0; i < 5; ++i) (void)perception.process(walkFrame(i));
  EXPECT_EQ(3u, perception.map().layers().maps.size());
  EXPECT_EQ(given.staticGrid(), perception.map().staticGrid());
  EXPECT_DOUBLE_EQ(0.4, perception.map().movingObjects().time());
  EXPECT_TRUE(given.movingObjects().isEmpty()) << "a copy was filled";
}

TEST(PerceptionTest, EveryStageIsTimed) {
  Perception perception(nullptr, {});
  (void)perception.process(walkFrame(0));
  const auto stages = perception.times().summary();
  for (const char* stage : {"frame", "objects", "map_update"}) {
    EXPECT_EQ(1u, stages.at(stage).count) << stage;
  }
}

TEST(PerceptionTest, RefusesParametersOutOfRangeEvenWithoutImages) {
  const auto errorOf = [](auto change) {
    PerceptionParams params;
    change(params);
    return test::inputErrorOf([&] { Perception perception(nullptr, params); });
  };
  EXPECT_EQ("[slam] features: '0' is out of range [50 .. 3000]",
            errorOf([](PerceptionParams& p) { p.slam.features = 0; }));
  EXPECT_EQ("[grid] period_s: '-1' is out of range [s, 0 .. 100]",
            errorOf([](PerceptionParams& p) { p.grid.period_s = -1.0; }));
  EXPECT_EQ("[detect] period_s: '-1' is out of range [s, 0 .. 100]",
            errorOf([](PerceptionParams& p) { p.detection.detect.period_s = -1.0; }));
}

}  // namespace
}  // namespace headway::pipeline
