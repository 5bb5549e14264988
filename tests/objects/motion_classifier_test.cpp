// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "track_evidence.h"

namespace headway::objects {
namespace {

constexpr MotionGroup kGroup = MotionGroup::kVehicle;  // moving above 0.8 m/s, static below 0.4 m/s

TEST(MotionClassifierTest, IsUnknownBeforeTheFirstMeasurement) {
  const MotionClassifier classifier{MotionClassParams()};
  EXPECT_EQ(classifier.state(), MotionState::kUnknown);
  EXPECT_FALSE(classifier.moving());
  EXPECT_FALSE(classifier.standing());
}

TEST(MotionClassifierTest, AFastObjectOfCertainSpeedIsMoving) {
  MotionClassifier classifier{MotionClassParams()};
  classifier.update(0.0, 0.7, 0.01, kGroup);
  EXPECT_EQ(classifier.state(), MotionState::kStatic);
  classifier.update(0.1, 0.9, 0.01, kGroup);
  EXPECT_EQ(classifier.state(), MotionState::kMoving);
}

TEST(MotionClassifierTest, AnInsignificantSpeedIsUnknown) {
  MotionClassifier classifier{MotionClassParams()};
  classifier.update(0.0, 2.0, 0.7, kGroup);  // below 3 standard deviations
  EXPECT_EQ(classifier.state(), MotionState::kUnknown);
  classifier.update(0.1, 2.2, 0.7, kGroup);
  EXPECT_EQ(classifier.state(), MotionState::kMoving);
}

TEST(MotionClassifierTest, BecomesStaticAfterTheTimeBelowTheLowerSpeed) {
  MotionClassifier classifier{MotionClassParams()};
  classifier.update(0.0, 5.0, 0.05, kGroup);
  for (int k = 1; k <= 4; ++k) {
    classifier.update(0.1 * k, 0.1, 0.05, kGroup);
    EXPECT_TRUE(classifier.moving()) << k;
  }
  classifier.update(0.55, 0.1, 0.05, kGroup);
  EXPECT_EQ(classifier.state(), MotionState::kStatic);
}

TEST(MotionClassifierTest, SpeedsBetweenTheLimitsKeepTheState) {
  MotionClassifier moving{MotionClassParams()}, fixed{MotionClassParams()};
  moving.update(0.0, 5.0, 0.05, kGroup);
  fixed.update(0.0, 0.0, 0.05, kGroup);
  for (int k = 1; k < 30; ++k) {
    moving.update(0.1 * k, 0.6, 0.05, kGroup);
    fixed.update(0.1 * k, 0.6, 0.05, kGroup);
  }
  EXPECT_EQ(moving.state(), MotionState::kMoving);
  EXPECT_EQ(fixed.state(), MotionState::kStatic);
}

TEST(MotionClassifierTest, LimitsDependOnTheClass) {
  MotionClassifier vehicle{MotionClassParams()}, pedestrian{MotionClassParams()};
  vehicle.update(0.0, 0.5, 0.01, MotionGroup::kVehicle);
  pedestrian.update(0.0, 0.5, 0.01, MotionGroup::kPedestrian);
  EXPECT_FALSE(vehicle.moving());
  EXPECT_TRUE(pedestrian.moving());
}

}  // namespace
}  // namespace headway::objects
