// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "image_formation.h"

namespace headway::sim {
namespace {

TEST(CameraClockTest, KeepsTheBeatByDefault) {
  CameraClock clock(CameraParams{}, 1);
  for (int i = 0; i < 50; ++i) {
    const auto beat = clock.next();
    EXPECT_DOUBLE_EQ(beat.time_s, 0.1 * i);
    EXPECT_FALSE(beat.lost);
  }
}

TEST(CameraClockTest, BeginsOnTimeWithAFrameThatIsNotLost) {
  CameraParams params;
  params.jitter_s = 0.02;
  params.drop_ratio = 1.0;
  CameraClock clock(params, 2);
  const auto first = clock.next();
  EXPECT_EQ(first.time_s, 0.0);
  EXPECT_FALSE(first.lost);
  EXPECT_TRUE(clock.next().lost);
}

TEST(CameraClockTest, WandersAboutTheBeatAndLosesItsShare) {
  CameraParams params;
  params.rate_hz = 20.0;
  params.jitter_s = 0.004;
  params.drop_ratio = 0.25;
  CameraClock clock(params, 3);
  constexpr int kBeats = 4000;
  double sum = 0.0, squares = 0.0;
  int lost = 0;
  for (int i = 0; i < kBeats; ++i) {
    const auto beat = clock.next();
    const double off_beat = beat.time_s - 0.05 * i;
    EXPECT_LE(std::abs(off_beat), 3.0 * params.jitter_s + 1e-9);
    sum += off_beat;
    squares += off_beat * off_beat;
    lost += beat.lost ? 1 : 0;
  }
  EXPECT_NEAR(sum / kBeats, 0.0, 0.0003) << "it does not drift away";
  EXPECT_NEAR(std::sqrt(squares / kBeats), params.jitter_s, 0.0003);
  EXPECT_NEAR(lost / static_cast<double>(kBeats), params.drop_ratio, 0.03);
}

}  // namespace
}  // namespace headway::sim
