// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/track.h>

namespace headway {
namespace {

TEST(TrackTest, StartsWithoutMotionClassification) {
  const Track track;
  EXPECT_EQ(track.motion_state, MotionState::kUnknown);
  EXPECT_FALSE(isMoving(track));
}

TEST(TrackTest, OnlyTheMovingStateIsMoving) {
  Track track;
  track.motion_state = MotionState::kMoving;
  EXPECT_TRUE(isMoving(track));
  track.motion_state = MotionState::kStatic;
  EXPECT_FALSE(isMoving(track));
}

TEST(TrackTest, NamesItsMotionStates) {
  EXPECT_EQ(toString(MotionState::kUnknown), "unknown");
  EXPECT_EQ(toString(MotionState::kMoving), "moving");
  EXPECT_EQ(toString(MotionState::kStatic), "static");
}

}  // namespace
}  // namespace headway
