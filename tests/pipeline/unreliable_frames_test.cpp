// SPDX-License-Identifier: BSD-3-Clause
// What becomes of frames whose pose cannot be trusted.

#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/pipeline/perception.h>
#include <headway_test/textured_world.h>

#include <utility>

namespace headway::pipeline {
namespace {

using slam::TrackingStatus;

/// A robot that drives through a hall past a pedestrian, with images that are wrong at times.
class UnreliableFramesTest : public testing::Test {
 protected:
  UnreliableFramesTest() : hall_(test::smallCamera()) {
    hall_.addRoom(12.0, 8.0, 4.0);
    PerceptionParams params;
    params.slam.features = 250;
    perception_ = std::make_unique<Perception>(hall_.camera(), params);
  }

  static Pose onPath(double step) {
    Pose pose = Pose::Identity();
    pose.translation().x() = 0.05 * step - 2.0;
    return pose;
  }

  /// The next frame as it should be.
  RecordedFrame next() {
    RecordedFrame frame;
    frame.index = static_cast<std::size_t>(frames_++);
    frame.time = time_;
    frame.stereo = hall_.frame(frame.index, frame.time, onPath(step_));
    time_ += 0.1 * pace_;
    step_ += pace_;
    Detection pedestrian;
    pedestrian.object_class = ObjectClass::kPedestrian;
    pedestrian.score = 0.9;
    pedestrian.box3d = Box3d{};
    pedestrian.box3d->centre << 0.5, 0.0, 3.0;
    pedestrian.box3d->length = 0.8;
    pedestrian.box3d->width = 0.6;
    pedestrian.box3d->height = 1.75;
    frame.detections.emplace();
    frame.detections->time = frame.time;
    frame.detections->items.push_back(pedestrian);
    return frame;
  }

  void drive(int frames) {
    for (int i = 0; i < frames; ++i) {
      ASSERT_EQ(perception_->process(next()).camera.status, TrackingStatus::kTracked) << frames_;
    }
  }

  test::TexturedWorld hall_;
  std::unique_ptr<Perception> perception_;

  double pace_ = 1.0;  ///< of the frames that follow, in steps and tenths of seconds

 private:
  int frames_ = 0;
  double time_ = 0.0;
  double step_ = 0.0;
};

TEST_F(UnreliableFramesTest, AFrozenCameraAddsNothingToTheMap) {
  drive(12);
  const RecordedFrame seen = next();
  (void)perception_->process(seen);
  const auto landmarks = perception_->map().staticMap()->landmarks.size();
  for (int i = 0; i < 8; ++i) {
    RecordedFrame frame = next();
    frame.stereo->left = seen.stereo->left.clone();
    frame.stereo->right = seen.stereo->right.clone();
    const auto update = perception_->process(frame);
    EXPECT_EQ(update.camera.status, TrackingStatus::kUnreliable);
    EXPECT_EQ(update.objects.detections_dropped.at("camera_lost"), 1U);
    for (const Track& track : update.objects.tracks) EXPECT_NE(track.last_seen, update.time);
  }
  EXPECT_EQ(perception_->map().staticMap()->landmarks.size(), landmarks);
  EXPECT_EQ(perception_->warnings().at("camera_frozen").count, 8U);
  const auto update = perception_->process(next());
  EXPECT_EQ(update.camera.status, TrackingStatus::kTracked);
  EXPECT_EQ(update.objects.detections_used, 1U);
}

TEST_F(UnreliableFramesTest, AFrozenLeftImageIsUnreliableUntilASecondAfter) {
  drive(12);
  const RecordedFrame seen = next();
  (void)perception_->process(seen);
  for (int i = 0; i < 17; ++i) {
    RecordedFrame frame = next();
    if (i < 8) frame.stereo->left = seen.stereo->left.clone();
    const auto status = perception_->process(frame).camera.status;
    EXPECT_TRUE(status == TrackingStatus::kUnreliable || status == TrackingStatus::kLost) << i;
  }
  EXPECT_EQ(perception_->warnings().at("one_image").count, 8U);
  for (int i = 0; i < 5; ++i) (void)perception_->process(next());
  drive(3);
}

TEST_F(UnreliableFramesTest, AFrozenEyeIsNotHeldForASlowCamera) {
  for (const bool is_left : {true, false}) {
    pace_ = 1.0;
    drive(12);
    pace_ = 0.03;  // 1.5 mm a frame
    drive(30);
    const RecordedFrame seen = next();
    (void)perception_->process(seen);
    for (int i = 0; i < 20; ++i) {
      RecordedFrame frame = next();
      cv::Mat& image = is_left ? frame.stereo->left : frame.stereo->right;
      image = (is_left ? seen.stereo->left : seen.stereo->right).clone();
      EXPECT_EQ(perception_->process(frame).camera.status, TrackingStatus::kUnreliable) << i;
    }
    pace_ = 1.0;
    for (int i = 0; i < 15; ++i) (void)perception_->process(next());
  }
}

TEST_F(UnreliableFramesTest, ImagesOfAnotherSizeChangeNothing) {
  drive(5);
  RecordedFrame frame = next();
  RecordedFrame cut = frame;
  cut.stereo->left = frame.stereo->left.colRange(0, frame.stereo->left.cols / 2);
  const auto trajectory = perception_->trajectory().size();
  EXPECT_THROW((void)perception_->process(cut), InputError);
  RecordedFrame without_right = frame;
  without_right.stereo->right.release();
  EXPECT_THROW((void)perception_->process(without_right), InputError);
  EXPECT_EQ(perception_->trajectory().size(), trajectory);
  const auto update = perception_->process(frame);
  EXPECT_EQ(update.camera.status, TrackingStatus::kTracked);
  EXPECT_TRUE(update.findings.empty());
}

/// A robot with wheels whose host processes every third frame of the source alone.
TEST_F(UnreliableFramesTest, MotionSinceAFrameThatWasSkippedIsLeftOutAndSaid) {
  drive(1);
  for (int i = 0; i < 15; ++i) {
    for (int skipped = 0; skipped < 2; ++skipped) (void)next();
    RecordedFrame frame = next();
    frame.stereo->motion_prior.T_previous_current = onPath(41.0);
    const auto update = perception_->process(frame);
    EXPECT_EQ(update.camera.status, TrackingStatus::kTracked) << frame.index;
    ASSERT_EQ(update.findings.size(), 1U) << update.findings.back().text;
    EXPECT_EQ(update.findings[0].name, "motion_left_out");
  }
  EXPECT_EQ(perception_->warnings().size(), 1U);
}

TEST_F(UnreliableFramesTest, MotionThatIsJoinedOverSkippedFramesIsUsed) {
  drive(1);
  for (int i = 0; i < 15; ++i) {
    RecordedFrame frame = next();
    frame.stereo->motion_prior.T_previous_current = onPath(41.0);
    for (int skipped = 0; skipped < 2; ++skipped) {
      const StereoFrame before = *frame.stereo;
      frame = next();
      frame.stereo->motion_prior.T_previous_current = onPath(41.0);
      frame.stereo->motion_prior = joined(before, frame.stereo->motion_prior);
    }
    const auto update = perception_->process(frame);
    EXPECT_EQ(update.camera.status, TrackingStatus::kTracked) << frame.index;
    EXPECT_TRUE(update.findings.empty()) << update.findings.front().text;
  }
}

TEST_F(UnreliableFramesTest, SwappedImagesAreUnreliableWithinASecond) {
  drive(12);
  int trusted = 0;
  for (int i = 0; i < 15; ++i) {
    RecordedFrame frame = next();
    std::swap(frame.stereo->left, frame.stereo->right);
    const auto update = perception_->process(frame);
    trusted += i >= 10 && update.camera.status == TrackingStatus::kTracked ? 1 : 0;
  }
  EXPECT_EQ(trusted, 0);
  EXPECT_EQ(perception_->warnings().count("images_swapped"), 1U);
}

TEST_F(UnreliableFramesTest, WheelsThatContradictTheCameraAreNamed) {
  for (int i = 0; i < 12; ++i) {
    RecordedFrame frame = next();
    frame.stereo->motion_prior.T_previous_current = onPath(41.0);
    const auto status = perception_->process(frame).camera.status;
    EXPECT_EQ(status, TrackingStatus::kTracked) << i;
  }
  for (int i = 0; i < 5; ++i) {
    RecordedFrame frame = next();
    frame.stereo->motion_prior.T_previous_current = Pose::Identity();
    const auto status = perception_->process(frame).camera.status;
    EXPECT_EQ(status, i == 0 ? status : TrackingStatus::kUnreliable) << i;
  }
  EXPECT_EQ(perception_->warnings().count("odometry_contradicts"), 1U);
}

}  // namespace
}  // namespace headway::pipeline
