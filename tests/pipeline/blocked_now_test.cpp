// SPDX-License-Identifier: BSD-3-Clause
// What is blocked now, by the images alone: without detectors, with and without a map, and while
// the camera is lost.
#include <gtest/gtest.h>
#include <headway/map/map_query.h>
#include <headway/pipeline/perception.h>
#include <headway_test/textured_world.h>

#include <memory>

namespace headway::pipeline {
namespace {

using map::LocalState;

constexpr double kRoomHeight_m = 3.0;

StereoCamera robotCamera() {
  StereoCamera camera = test::smallCamera();
  camera.width = 640;
  camera.height = 400;
  camera.fx = camera.fy = 400.0;
  camera.cx = 319.5;
  camera.cy = 199.5;
  camera.baseline_m = 0.2;
  camera.T_robot_cam.linear() = expSo3({0.0, 15.0 * kDegree, 0.0}) * camera.T_robot_cam.linear();
  camera.T_robot_cam.translation().z() = 0.5;
  return camera;
}

/// A robot that drives slowly through a room, without detectors.
class BlockedNowTest : public testing::TestWithParam<bool> {
 protected:
  BlockedNowTest()
      : room_(robotCamera()), perception_(std::make_unique<Perception>(room_.camera(), params())) {
    room_.addRoom(10.0, 6.0, kRoomHeight_m);
  }

  static PerceptionParams params() {
    PerceptionParams params;
    params.detection.detector = "none";
    params.slam.features = 250;
    params.slam.mapping = GetParam();
    return params;
  }

  PerceptionUpdate see(int frames, bool is_covered = false) {
    PerceptionUpdate update;
    for (int i = 0; i < frames; ++i) {
      RecordedFrame frame;
      frame.index = index_++;
      frame.time = 0.1 * static_cast<double>(frame.index);
      Pose pose(Eigen::Translation3d(0.02 * static_cast<double>(frame.index) - 3.0, 0.0,
                                     -0.5 * kRoomHeight_m));
      frame.stereo = room_.frame(frame.index, frame.time, pose);
      if (is_covered) {
        frame.stereo->left.setTo(cv::Scalar(9));
        frame.stereo->right.setTo(cv::Scalar(9));
      }
      update = perception_->process(frame);
    }
    now_ = update.time;
    x_ = update.camera.T_odom_robot.translation().x();
    return update;
  }

  /// Somebody, 0.5 m wide and 1.7 m high, a distance before where the robot is now.
  void stepIn(double ahead_m) {
    const double x = 0.02 * static_cast<double>(index_) - 3.0 + ahead_m;
    room_.boards.push_back({{x, -0.25, -0.5 * kRoomHeight_m},
                            Eigen::Vector3d::UnitY(),
                            Eigen::Vector3d::UnitZ(),
                            0.5,
                            1.7,
                            {2.3, 1.1}});
  }
  void stepOut() { room_.boards.pop_back(); }

  [[nodiscard]] bool isFree(double ahead_m, double aside_m = 0.0) const {
    const map::TimedPose pose{now_, {x_ + ahead_m, aside_m}, 0.0};
    return perception_->map().inOdometryAt(now_).timeToCollision({0.3, 0.3, true}, {pose}).isFree();
  }

  test::TexturedWorld room_;
  std::unique_ptr<Perception> perception_;
  std::size_t index_ = 0;
  Time now_ = 0.0;
  double x_ = 0.0;  ///< of the robot, odometry frame [m]
};

TEST_P(BlockedNowTest, GroundIsFreeUntilSomebodyStepsOnIt) {
  see(15);
  EXPECT_TRUE(isFree(1.5));
  EXPECT_TRUE(isFree(1.2, 0.4));
  stepIn(1.5);
  see(1);
  EXPECT_FALSE(isFree(1.48)) << "in the first frame";
  see(4);
  EXPECT_FALSE(isFree(1.4));
  EXPECT_FALSE(isFree(2.2)) << "behind, whatever the map says";
  const auto query = perception_->map().inOdometryAt(now_);
  EXPECT_FALSE(query.blockedNow().empty());
  stepOut();
  see(8);
  EXPECT_TRUE(isFree(1.2));
}

TEST_P(BlockedNowTest, WhoStandsThereFromTheBeginningIsNeverFree) {
  stepIn(1.8);  // of whom nothing moves and no detector knows
  int frees = 0;
  for (int i = 0; i < 30; ++i) {
    see(1);
    const double ahead_m = 1.8 - 0.02 * static_cast<double>(index_ - 1);
    frees += isFree(ahead_m) || isFree(ahead_m, 0.2) || isFree(ahead_m, -0.2);
  }
  EXPECT_EQ(0, frees);
  EXPECT_TRUE(isFree(0.75, 0.25)) << "before";
}

TEST_P(BlockedNowTest, ALoadedMapFreesNothingThatIsInView) {
  PerceptionParams mapping = params();
  mapping.slam.mapping = true;
  perception_ = std::make_unique<Perception>(room_.camera(), mapping);
  see(40);  // the map of the empty room
  const map::StoredMap stored = perception_->stored();
  perception_ = std::make_unique<Perception>(room_.camera(), params());
  perception_->resume(stored);
  index_ = 0;
  stepIn(1.5);
  see(5);
  EXPECT_FALSE(isFree(1.42));
  EXPECT_FALSE(isFree(1.42, 0.2));
  EXPECT_TRUE(isFree(0.7)) << "before";
  EXPECT_GT(perception_->map().staticGrid()->getSizeX(), 0u) << "the map is loaded";
}

TEST_P(BlockedNowTest, WhatIsNotSeenForASecondIsNotFree) {
  see(15);
  ASSERT_TRUE(isFree(1.5));
  see(10, true);
  EXPECT_FALSE(isFree(1.5));
}

INSTANTIATE_TEST_SUITE_P(Mapping, BlockedNowTest, testing::Bool());

TEST(BlockedNowOffTest, NobodyWhoDoesNotAskPaysForIt) {
  test::TexturedWorld room(robotCamera());
  room.addRoom(10.0, 6.0, kRoomHeight_m);
  PerceptionParams params;
  params.detection.detector = "none";
  params.grid.local = false;
  Perception perception(room.camera(), params);
  RecordedFrame frame;
  frame.stereo = room.frame(0, 0.0, Pose(Eigen::Translation3d(-3.0, 0.0, -1.5)));
  (void)perception.process(frame);
  EXPECT_EQ(nullptr, perception.map().local());
}

}  // namespace
}  // namespace headway::pipeline
