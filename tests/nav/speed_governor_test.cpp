// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/nav/speed_governor.h>
#include <headway_test/input_error.h>
#include <headway_test/walking_track.h>

#include <limits>

namespace headway::nav {
namespace {

using test::walkingTrack;

constexpr GroundTwist kAhead{1.0, 0.0, 0.0};

PredictiveObstaclesParams params() {
  PredictiveObstaclesParams values;
  values.robot.radius_m = 0.32;
  values.robot.length_m = 0.5;
  values.robot.width_m = 0.4;
  values.robot.max_speed_mps = 1.0;
  return values;
}

/// A robot at the origin that drives at the speed of its command.
GroundState driving() {
  GroundState robot;
  robot.twist = kAhead;
  return robot;
}

double speedRatioAmong(const std::vector<Track>& tracks, double age_s = 0.0) {
  SpeedGovernor governor(params());
  return governor.speedRatio(kAhead, driving(), tracks, age_s);
}

TEST(SpeedGovernorTest, KeepsTheSpeedWithoutContacts) {
  EXPECT_EQ(speedRatioAmong({}), 1.0);
  EXPECT_EQ(speedRatioAmong({walkingTrack(1, {5.0, 5.0}, {0.0, 1.0})}), 1.0) << "he walks away";
  EXPECT_EQ(speedRatioAmong({walkingTrack(1, {60.0, 0.0}, {0.0, 1.0})}), 1.0) << "he is far";
}

TEST(SpeedGovernorTest, SlowsForAPersonCrossingAtTheSameTime) {
  const double ratio = speedRatioAmong({walkingTrack(1, {1.5, -1.5}, {0.0, 1.0}, 0.1)});
  EXPECT_LT(ratio, 0.8);
}

TEST(SpeedGovernorTest, DoesNotSlowForAPersonWhoHasCrossed) {
  EXPECT_EQ(speedRatioAmong({walkingTrack(1, {2.0, 0.3}, {0.0, 1.2}, 0.1)}), 1.0);
}

TEST(SpeedGovernorTest, DoesNotSlowWhereThatWouldCauseAContact) {
  // The person crosses just behind the robot at its full speed.
  EXPECT_EQ(speedRatioAmong({walkingTrack(1, {0.2, -1.3}, {0.0, 1.0}, 0.1)}), 1.0);
}

TEST(SpeedGovernorTest, StopsBeforeAPersonOnItsPath) {
  EXPECT_LE(speedRatioAmong({walkingTrack(1, {0.9, 0.0}, {0.0, 0.05}, 0.1)}), 0.2);
}

TEST(SpeedGovernorTest, DoesNotTurnWhileSomebodyWalksIntoIt) {
  SpeedGovernor governor(params());
  GroundState robot;  // at rest
  const Track track = walkingTrack(1, {1.2, 0.0}, {-1.2, 0.0}, 0.05);
  EXPECT_EQ(governor.speedRatio({0.0, 0.0, 1.0}, robot, {track}, 0.0), 0.0);
  EXPECT_EQ(governor.speedRatio({0.0, 0.0, 1.0}, robot, {}, 0.0), 1.0);
  const Track towards_a_corner = walkingTrack(2, {0.72, -0.39}, {-1.0, 0.78}, 0.1);
  EXPECT_EQ(governor.speedRatio({0.0, 0.0, 0.8}, robot, {towards_a_corner}, 0.0), 0.0)
      << "nor slowly";
}

TEST(SpeedGovernorTest, SlowsLessForAnImprobableFuture) {
  Track track = walkingTrack(1, {1.5, -1.5}, {0.0, 1.0}, 0.1);
  track.predictions.push_back(walkingTrack(1, {1.5, -1.5}, {0.0, -1.0}, 0.1).predictions.front());
  const auto at = [&](double crosses) {
    track.predictions[0].probability = crosses;
    track.predictions[1].probability = 1.0 - crosses;
    return speedRatioAmong({track});
  };
  EXPECT_LT(at(0.9), 1.0);
  EXPECT_EQ(at(0.01), 1.0);
}

TEST(SpeedGovernorTest, PredictsAnOldMapToNow) {
  const Track track = walkingTrack(1, {1.5, -2.0}, {0.0, 1.0}, 0.1);
  EXPECT_LT(speedRatioAmong({track}, 0.5), 1.0);
  EXPECT_LT(speedRatioAmong({track}, 0.5), speedRatioAmong({track}, -2.0) + 1e-9);
}

TEST(SpeedGovernorTest, IgnoresTentativeStaticAndInvalidTracks) {
  Track standing = walkingTrack(1, {0.9, 0.0}, {0.0, 0.05});
  standing.motion_state = MotionState::kStatic;
  Track tentative = walkingTrack(2, {0.9, 0.0}, {0.0, 0.05});
  tentative.status = TrackStatus::kTentative;
  Track broken = walkingTrack(3, {0.9, 0.0}, {0.0, 0.05});
  broken.position.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(speedRatioAmong({standing, tentative, broken}), 1.0);
}

TEST(SpeedGovernorTest, IsTheSameEachTime) {
  SpeedGovernor governor(params());
  const std::vector<Track> tracks = {walkingTrack(1, {1.5, -1.5}, {0.0, 1.0}, 0.2),
                                     walkingTrack(2, {2.0, 1.8}, {0.0, -1.1}, 0.2)};
  const double first = governor.speedRatio(kAhead, driving(), tracks, 0.0);
  static_cast<void>(governor.speedRatio(kAhead, driving(), {}, 0.0));
  EXPECT_EQ(governor.speedRatio(kAhead, driving(), tracks, 0.0), first);
}

TEST(SpeedGovernorTest, RefusesParametersOutOfRange) {
  PredictiveObstaclesParams values = params();
  values.governor.patience_s = 0.0;
  EXPECT_EQ("[nav] patience_s: '0' is out of range [s, 0.1 .. 100]",
            test::inputErrorOf([&] { SpeedGovernor governor(values); }));
}

double speedRatioOn(const SpeedGovernor::GroundNow& ground, const GroundTwist& command) {
  SpeedGovernor governor(params());
  GroundState robot;
  robot.twist = command;
  return governor.speedRatio(command, robot, {}, 0.1, ground);
}

TEST(SpeedGovernorTest, KnowsHowLongItTakesToStart) {
  const Track crosser = walkingTrack(1, {0.9, -2.3}, {0.0, 1.0});
  auto values = params();
  GroundState robot;
  const auto ratioOf = [&](double acceleration_mps2) {
    values.robot.acceleration_mps2 = acceleration_mps2;
    return SpeedGovernor(values).speedRatio(kAhead, robot, {crosser}, 0.0);
  };
  EXPECT_EQ(1.0, ratioOf(20.0)) << "it has passed before they come";
  EXPECT_LT(ratioOf(0.5), 1.0) << "it would be in their way";
}

TEST(SpeedGovernorTest, DrivesNoFasterThanItCanBrakeOnFreeGround) {
  const auto freeTo = [](double x) {
    return [x](const Eigen::Vector2d& place, double) {
      return place.x() < x ? map::LocalState::kFree : map::LocalState::kUnknown;
    };
  };
  // At 1 m/s it brakes within 0.25 m of reaction and 0.5 m, and is 0.25 m long before its origin.
  EXPECT_EQ(speedRatioOn(freeTo(1.5), kAhead), 1.0);
  const double slowed = speedRatioOn(freeTo(0.7), kAhead);
  EXPECT_GT(slowed, 0.1);
  EXPECT_LT(slowed, 0.8);
  EXPECT_LE(speedRatioOn(freeTo(0.33), kAhead), 0.1) << "it creeps";
  EXPECT_EQ(speedRatioOn(freeTo(0.26), kAhead), 0.0);
  EXPECT_EQ(speedRatioOn(freeTo(0.33), {-1.0, 0.0, 0.0}), 1.0) << "backwards it is free";
}

TEST(SpeedGovernorTest, TurnsOnTheSpotWhereNothingIsBlocked) {
  for (const auto state : {map::LocalState::kNotInView, map::LocalState::kUnknown}) {
    const auto everywhere = [state](const Eigen::Vector2d&, double) { return state; };
    EXPECT_EQ(speedRatioOn(everywhere, {0.0, 0.0, 1.0}), 1.0);
  }
  const auto entered = [](const Eigen::Vector2d&, double) { return map::LocalState::kEntered; };
  EXPECT_EQ(speedRatioOn(entered, {0.0, 0.0, 1.0}), 0.0) << "into somebody who is beside it now";
  // Somebody at its left, within reach of its corners.
  const auto beside = [](double left_m) {
    return [left_m](const Eigen::Vector2d& place, double) {
      return place.y() > left_m ? map::LocalState::kBlocked : map::LocalState::kFree;
    };
  };
  EXPECT_LT(speedRatioOn(beside(0.27), {0.0, 0.0, 1.0}), 0.8);
  EXPECT_EQ(speedRatioOn(beside(0.215), {0.0, 0.0, 1.0}), 0.0);
  EXPECT_EQ(speedRatioOn(beside(0.215), kAhead), 1.0);
}

TEST(SpeedGovernorTest, DoesNotCreepTowardsWhomItSeesNoMore) {
  const auto entered = [](const Eigen::Vector2d& place, double) {
    return place.x() > 0.265 ? map::LocalState::kUnknown : map::LocalState::kFree;
  };
  EXPECT_EQ(speedRatioOn(entered, {0.2, 0.0, 0.0}), 0.0) << "within its radius";
  EXPECT_EQ(speedRatioOn(entered, {-0.2, 0.0, 0.0}), 1.0);
}

}  // namespace
}  // namespace headway::nav
