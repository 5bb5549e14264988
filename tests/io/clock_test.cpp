// SPDX-License-Identifier: BSD-3-Clause
// Clocks that are set, and sensors with clocks of their own.
#include <gmock/gmock.h>
#include <headway/io/live_source.h>
#include <headway/io/mrpt_time.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>

#include "foreign_recording.h"
#include "synthetic_recording.h"

namespace headway::io {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A camera at 10 Hz with an inertial sensor at 50 Hz and odometry at 10 Hz.
class ClockTest : public ::testing::Test {
 protected:
  /// Everything of frame i, with these times added to the clocks.
  std::optional<LiveFrame> step(int i, double camera_s, double imu_s, bool has_image = true) {
    for (int k = 4; k >= 0; --k) {
      auto imu = mrpt::obs::CObservationIMU::Create();
      imu->timestamp = mrptTime(test::frameTime(i) - 0.02 * k + imu_s);
      imu->sensorLabel = "imu";
      for (const auto axis : {mrpt::obs::IMU_WX, mrpt::obs::IMU_WY}) imu->set(axis, 0.0);
      imu->set(mrpt::obs::IMU_WZ, 0.2);
      source_.push(imu);
    }
    auto odometry = mrpt::obs::CObservationOdometry::Create();
    odometry->timestamp = mrptTime(test::frameTime(i) + camera_s);
    odometry->sensorLabel = "wheels";
    odometry->odometry = {0.1 * i, 0.0, 0.0};
    source_.push(odometry);
    if (!has_image) return std::nullopt;
    source_.push(test::wallObservation(i % 4, test::frameTime(i) + camera_s));
    return source_.hasFrame() ? source_.next() : std::nullopt;
  }

  LiveSource source_;
};

TEST_F(ClockTest, FramesGoOnAfterTheClockIsSetBack) {
  for (int i = 0; i < 5; ++i) (void)step(i, 0.0, 0.0);
  EXPECT_FALSE(step(5, -3600.0, -3600.0));
  EXPECT_FALSE(step(6, -3600.0, -3600.0));
  const auto first = step(7, -3600.0, -3600.0);
  ASSERT_TRUE(first);
  EXPECT_EQ(7u, first->frame.index);
  EXPECT_NEAR(test::frameTime(7) - 3600.0, first->frame.time, 1e-6);
  EXPECT_FALSE(first->frame.stereo->motion_prior.T_previous_current);
  for (int i = 8; i < 11; ++i) (void)step(i, -3600.0, -3600.0);
  const auto later = step(11, -3600.0, -3600.0);
  ASSERT_TRUE(later);
  const MotionPrior& prior = later->frame.stereo->motion_prior;
  ASSERT_TRUE(prior.T_previous_current && prior.R_previous_current);
  EXPECT_NEAR(0.1, prior.T_previous_current->translation().x(), 1e-6);
  EXPECT_EQ(2u, source_.skipped().at("time_backwards"));
}

TEST_F(ClockTest, FramesGoOnAfterAStepOfASecond) {
  for (int i = 0; i < 20; ++i) (void)step(i, 0.0, 0.0);
  int frames = 0;
  for (int i = 20; i < 40; ++i) {
    const auto live = step(i, -1.0, -1.0);
    if (!live) continue;
    ++frames;
    const auto& prior = live->frame.stereo->motion_prior;
    if (prior.T_previous_current) {
      EXPECT_NEAR(0.1, prior.T_previous_current->translation().x(), 1e-6);
    }
  }
  EXPECT_GE(frames, 17);
}

TEST_F(ClockTest, FramesGoOnAfterTheClockIsSetAhead) {
  for (int i = 0; i < 5; ++i) (void)step(i, 0.0, 0.0);
  EXPECT_FALSE(step(5, 3600.0, 3600.0)) << "one frame may be an error";
  EXPECT_TRUE(step(6, 3600.0, 3600.0));
  EXPECT_TRUE(step(7, 3600.0, 3600.0));
}

TEST_F(ClockTest, TwoFramesOfThePastAreDropped) {
  for (int i = 0; i < 5; ++i) (void)step(i, 0.0, 0.0);
  EXPECT_FALSE(step(1, 0.0, 0.0));
  EXPECT_FALSE(step(2, 0.0, 0.0));
  EXPECT_TRUE(step(5, 0.0, 0.0));
  EXPECT_FALSE(step(3, 0.0, 0.0));
  EXPECT_TRUE(step(6, 0.0, 0.0));
  EXPECT_EQ(3u, source_.skipped().at("time_backwards"));
}

TEST_F(ClockTest, ASensorWithAClockOfItsOwnIsNamed) {
  for (int i = 0; i < 30; ++i) (void)step(i, 0.0, 12.5);
  const auto warnings = source_.warnings();
  ASSERT_EQ(1u, warnings.size());
  const auto& [name, warning] = *warnings.begin();
  EXPECT_EQ("clocks_differ_imu", name);
  EXPECT_THAT(warning.text, HasSubstr("'imu' are 12.500 s after"));
  EXPECT_GE(warning.count, 15u);
}

TEST_F(ClockTest, OneClockGivesNoWarning) {
  for (int i = 0; i < 30; ++i) (void)step(i, 0.0, 0.0);
  for (int i = 30; i < 130; ++i) (void)step(i, 0.0, 0.0, false);  // the camera is unplugged
  for (int i = 130; i < 160; ++i) (void)step(i, 0.0, 0.0);
  EXPECT_THAT(source_.warnings(), IsEmpty());
}

}  // namespace
}  // namespace headway::io
