// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/live_source.h>
#include <headway/io/mrpt_time.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <thread>

#include "foreign_recording.h"
#include "synthetic_recording.h"

namespace headway::io {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

mrpt::obs::CObservationOdometry::Ptr odometry(Time time, double x) {
  auto observation = mrpt::obs::CObservationOdometry::Create();
  observation->timestamp = mrptTime(time);
  observation->odometry = mrpt::poses::CPose2D(x, 0.0, 0.0);
  return observation;
}

mrpt::obs::CObservationIMU::Ptr gyroscope(Time time, double yaw_rate) {
  auto observation = mrpt::obs::CObservationIMU::Create();
  observation->timestamp = mrptTime(time);
  observation->set(mrpt::obs::IMU_WX, 0.0);
  observation->set(mrpt::obs::IMU_WY, 0.0);
  observation->set(mrpt::obs::IMU_WZ, yaw_rate);
  return observation;
}

class LiveSourceTest : public ::testing::Test {
 protected:
  void pushWall(int i) { source_.push(test::wallObservation(i, test::frameTime(i))); }

  double now_s_ = 0.0;
  LiveSource source_{{}, [this] { return now_s_; }};
};

TEST_F(LiveSourceTest, ReturnsTheNewestFrameAndCountsOlderOnes) {
  for (int i = 0; i < 5; ++i) pushWall(i);
  ASSERT_NE(nullptr, source_.camera());
  EXPECT_EQ(4u, source_.next()->frame.index);
  EXPECT_EQ(4u, source_.dropped());
  for (int i = 5; i < 8; ++i) pushWall(i);
  EXPECT_EQ(7u, source_.next()->frame.index);
  EXPECT_EQ(6u, source_.dropped());
  pushWall(8);
  source_.close();
  const auto last = source_.next();
  EXPECT_EQ(8u, last->frame.index);
  EXPECT_TRUE(test::sameImage(last->frame.stereo->left, test::wall(8).left));
  EXPECT_FALSE(source_.next());
}

TEST_F(LiveSourceTest, TheFrameThatShowedTheCameraIsReplacedByANewerOne) {
  pushWall(0);
  pushWall(1);
  (void)source_.camera();
  pushWall(2);
  EXPECT_EQ(2u, source_.next()->frame.index);
  EXPECT_EQ(2u, source_.dropped());
}

TEST_F(LiveSourceTest, ArrivalIsThatOfTheSecondImage) {
  for (int i = 0; i < 4; ++i) {
    now_s_ = 10.0 + i;
    source_.push(test::singleImage(0, i, test::frameTime(i), "left"));
    now_s_ += 0.5;
    source_.push(test::singleImage(1, i, test::frameTime(i), "right"));
  }
  const auto live = source_.next();
  EXPECT_EQ(3u, live->frame.index);
  EXPECT_DOUBLE_EQ(13.5, live->arrival_s);
}

TEST(LiveSourceQueueTest, HoldsAtMostWhatTheOptionsName) {
  LiveSourceOptions options;
  options.max_waiting_samples = 20;
  options.max_waiting_items = 3;
  options.max_waiting_frames = 2;
  LiveSource source(options);
  for (int i = 0; i < 100; ++i) {
    source.push(test::wallObservation(i, test::frameTime(i)));
    for (int k = 0; k < 10; ++k) {
      source.push(gyroscope(test::frameTime(i) + 0.01 * k, 0.1));
      source.push(odometry(test::frameTime(i) + 0.01 * k, 0.1 * i));
    }
    const auto queues = source.queues();
    EXPECT_LE(queues.frames, 2u);
    EXPECT_LE(queues.motion_samples, 40u);
    EXPECT_LE(queues.items, 3u);
  }
  EXPECT_EQ(98u, source.dropped());
}

TEST_F(LiveSourceTest, MotionCoversDroppedFramesAndReachesTheNewestOne) {
  // The samples end 10 ms before the frame: the next ones have not arrived yet.
  const auto drive = [&](int from, int to) {
    for (int i = from; i < to; ++i) {
      for (int k = 0; k < 5; ++k) {
        const Time time = test::frameTime(i) - 0.09 + 0.02 * k;
        source_.push(gyroscope(time, 0.2));
        source_.push(odometry(time, time - 100.0));
      }
      pushWall(i);
    }
  };
  drive(0, 3);
  ASSERT_EQ(2u, source_.next()->frame.index);
  drive(3, 7);
  const auto live = source_.next();
  ASSERT_EQ(6u, live->frame.index);
  const MotionPrior& prior = live->frame.stereo->motion_prior;
  ASSERT_TRUE(prior.R_previous_current && prior.T_previous_current);
  EXPECT_NEAR(0.4 * 0.2, Eigen::AngleAxisd(*prior.R_previous_current).angle(), 1e-6);
  EXPECT_NEAR(0.4, prior.T_previous_current->translation().x(), 1e-6);
}

TEST_F(LiveSourceTest, MotionIsNotExtrapolatedAcrossAnOutage) {
  for (int i = 0; i < 3; ++i) {
    source_.push(gyroscope(test::frameTime(i) - 0.01, 0.2));
    pushWall(i);
  }
  (void)source_.next();
  pushWall(3);
  EXPECT_FALSE(source_.next()->frame.stereo->motion_prior.R_previous_current);
}

TEST_F(LiveSourceTest, BrokenImagesAreSkippedAndCounted) {
  for (int i = 0; i < 2; ++i) pushWall(i);
  (void)source_.next();
  auto other_size = test::wallObservation(2, test::frameTime(2));
  other_size->imageLeft.resize(80, 60, mrpt::img::CH_GRAY);
  other_size->imageRight.resize(80, 60, mrpt::img::CH_GRAY);
  source_.push(other_size);
  source_.close();
  EXPECT_FALSE(source_.next());
  EXPECT_EQ(1u, source_.skipped().at("image_size"));
}

TEST_F(LiveSourceTest, WithoutACameraIsAnErrorForTheConsumer) {
  source_.push(odometry(1.0, 0.0));
  source_.close();
  EXPECT_THAT(test::errorOf([&] { (void)source_.camera(); }), HasSubstr("neither stereo images"));
}

TEST_F(LiveSourceTest, ImagesThatCannotBeUsedAreSaidWithinTwoSeconds) {
  const auto pushEmpty = [this](int i) {
    auto pair = test::wallObservation(i, test::frameTime(i));
    pair->imageLeft = mrpt::img::CImage();
    source_.push(pair);
  };
  // A consumer waits in another thread.
  std::string error;
  std::thread consumer([&] { error = test::errorOf([&] { (void)source_.camera(); }); });
  for (int i = 0; i <= 25; ++i) {
    now_s_ = 50.0 + 0.1 * i;
    pushEmpty(i);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  source_.close();
  consumer.join();
  EXPECT_THAT(error, HasSubstr("none of the images can be used (broken_image "));
  EXPECT_THAT(error, HasSubstr("check camera, cable and driver"));
}

TEST_F(LiveSourceTest, ImagesWithoutCalibrationAreAnError) {
  for (int i = 0; i < 2; ++i) {
    auto pair = test::wallObservation(i, test::frameTime(i));
    pair->leftCamera = pair->rightCamera = mrpt::img::TCamera();
    pair->hasImageRight = false;  // as MRPT's driver for image folders
    source_.push(pair);
  }
  EXPECT_THAT(test::errorOf([&] { (void)source_.camera(); }),
              AllOf(HasSubstr("the images have none"), HasSubstr("--calibration FILE")));
}

TEST_F(LiveSourceTest, SaysWhatIsMissingOfACamera) {
  EXPECT_EQ("", source_.missing());
  source_.push(test::singleImage(0, 0, test::frameTime(0), "webcam"));
  EXPECT_THAT(source_.missing(),
              AllOf(HasSubstr("single images 'webcam'"), HasSubstr("images of two labels")));
  source_.push(test::singleImage(1, 0, test::frameTime(0), "right"));
  EXPECT_EQ("", source_.missing());
}

TEST(LiveSourceThreadTest, PushesFromSeveralThreadsReachTheConsumer) {
  LiveSource source;
  std::thread camera([&] {
    for (int i = 0; i < 60; ++i) {
      source.push(test::wallObservation(i % 4, test::frameTime(i)));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    source.close();
  });
  std::thread inertial([&] {
    for (int i = 0; i < 600; ++i) source.push(gyroscope(100.0 + 0.01 * i, 0.1));
  });
  std::size_t frames = 0;
  std::optional<std::size_t> last;
  while (const auto live = source.next()) {
    EXPECT_TRUE(!last || live->frame.index > *last);
    last = live->frame.index;
    ++frames;
  }
  camera.join();
  inertial.join();
  EXPECT_EQ(59u, last);
  EXPECT_EQ(60u, frames + source.dropped());
}

}  // namespace
}  // namespace headway::io
