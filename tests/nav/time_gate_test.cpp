// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/nav/moving_obstacles.h>
#include <headway_test/input_error.h>

namespace headway::nav {
namespace {

RobotMotionParams exactRobot() {
  RobotMotionParams robot;
  robot.radius_m = 0.5;
  robot.max_speed_mps = 2.0;
  robot.slow_ratio = 0.5;
  robot.early_slack_s = 0.0;
  robot.late_slack_s = 0.0;
  return robot;
}

TEST(TimeGateTest, TouchesAfterTheFreeWayAndPassesAfterTheWayBeyond) {
  const auto span = TimeGate(exactRobot()).touching(4.5);
  EXPECT_DOUBLE_EQ(span.from_s, 2.0);
  EXPECT_DOUBLE_EQ(span.to_s, 5.0);
}

TEST(TimeGateTest, FartherPointsAreTouchedLater) {
  const TimeGate gate(exactRobot());
  for (double distance = 0.6; distance < 10.0; distance += 0.3) {
    EXPECT_LT(gate.touching(distance).from_s, gate.touching(distance + 0.3).from_s);
    EXPECT_LT(gate.touching(distance).to_s, gate.touching(distance + 0.3).to_s);
  }
}

TEST(TimeGateTest, APointUnderTheRobotIsTouchedNow) {
  const auto span = TimeGate(exactRobot()).touching(0.3);
  EXPECT_LE(span.from_s, 0.0);
  EXPECT_GE(span.to_s, 0.0);
}

TEST(TimeGateTest, SlackLengthensTheSpan) {
  RobotMotionParams slack = exactRobot();
  slack.early_slack_s = 0.5;
  slack.late_slack_s = 0.25;
  const auto exact = TimeGate(exactRobot()).touching(3.0);
  const auto loose = TimeGate(slack).touching(3.0);
  EXPECT_DOUBLE_EQ(loose.from_s, exact.from_s - 0.5);
  EXPECT_DOUBLE_EQ(loose.to_s, exact.to_s + 0.25);
}

TEST(TimeGateTest, RefusesARobotThatCannotMove) {
  RobotMotionParams robot = exactRobot();
  robot.max_speed_mps = 0.0;
  EXPECT_EQ("[nav] robot_max_speed_mps: '0' is out of range [m/s, 0.05 .. 30]",
            test::inputErrorOf([&] { TimeGate gate(robot); }));
}

}  // namespace
}  // namespace headway::nav
