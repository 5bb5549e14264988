// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "attitude.h"
#include "robot.h"

namespace headway::sim {
namespace {

constexpr double kDriverStep_s = 0.02;

Route laneOf(const std::string& shape, double hill_height_m = 0.0) {
  RouteParams params;
  params.shape = shape;
  return makeRoute(params, hill_height_m);
}

TEST(RobotDriverTest, StartsAtTheRoutesStartInItsLane) {
  const Route route = laneOf("straight 100");
  const RobotDriver driver({}, 0.0, false, route, 1);
  const Eigen::Vector3d start = route.street.beside(route.start_s, route.robot_left);
  EXPECT_LT((driver.T_world_robot().translation() - start).norm(), 1e-9);
  EXPECT_FALSE(driver.arrived());
}

TEST(RobotDriverTest, ArrivesAtTheEndOfItsRoute) {
  const Route route = laneOf("straight 60, left 30 90, straight 30");
  RobotDriver driver({}, 0.0, false, route, 1);
  for (int i = 0; i < 4000 && !driver.arrived(); ++i) driver.advance(kDriverStep_s, {});
  EXPECT_TRUE(driver.arrived());
  EXPECT_NEAR(driver.state().s, route.end_s, 1.0);
}

TEST(RobotDriverTest, LeavesACurveNoFasterThanItsLateralAcceleration) {
  const Route route = laneOf("straight 60, left 20 90, straight 60");
  RouteParams params;
  params.speed_mps = 12.0;
  params.lateral_acceleration_mps2 = 1.5;
  RobotDriver driver(params, 0.0, false, route, 1);
  double at_the_curves_end = 0.0;
  for (int i = 0; i < 4000 && !driver.arrived(); ++i) {
    driver.advance(kDriverStep_s, {});
    const RobotState state = driver.state();
    const double curvature = std::abs(route.street.curvature(state.s));
    if (curvature > 0.9 / 20.0) at_the_curves_end = state.speed * state.speed * curvature;
  }
  EXPECT_GT(at_the_curves_end, 0.5 * params.lateral_acceleration_mps2);
  EXPECT_LT(at_the_curves_end, 1.2 * params.lateral_acceleration_mps2);
}

TEST(RobotDriverTest, WithoutRideStaysParallelToTheStreet) {
  const Route flat = laneOf("straight 80");
  RobotDriver driver({}, 0.0, false, flat, 1);
  for (int i = 0; i < 300; ++i) {
    driver.advance(kDriverStep_s, {});
    EXPECT_NEAR(pitchOf(driver.T_world_robot()), 0.0, 1e-9);
    EXPECT_NEAR(rollOf(driver.T_world_robot()), 0.0, 1e-9);
  }
}

TEST(RobotDriverTest, PitchesUpWhereTheStreetRises) {
  const Route hill = laneOf("straight 200", 6.0);
  RobotDriver driver({}, 0.0, false, hill, 1);
  for (int i = 0; i < 600; ++i) {
    driver.advance(kDriverStep_s, {});
    const double s = driver.state().s;
    const double rise = hill.street.at(s + 1.5).position.z() - hill.street.at(s - 1.5).position.z();
    EXPECT_NEAR(pitchOf(driver.T_world_robot()), -std::atan2(rise, 3.0), 1e-6);
  }
}

TEST(RobotDriverTest, RideHasTheStandardDeviationAskedFor) {
  const Route route = laneOf("straight 2000");
  constexpr double kRide_deg = 0.5;
  RobotDriver driver({}, kRide_deg, false, route, 3);
  double pitch = 0.0, roll = 0.0;
  constexpr int kSteps = 10000;
  for (int i = 0; i < kSteps; ++i) {
    driver.advance(kDriverStep_s, {});
    pitch += std::pow(pitchOf(driver.T_world_robot()), 2) / kSteps;
    roll += std::pow(rollOf(driver.T_world_robot()), 2) / kSteps;
  }
  EXPECT_NEAR(std::sqrt(pitch) * 180.0 / M_PI, kRide_deg, 0.2 * kRide_deg);
  EXPECT_NEAR(std::sqrt(roll) * 180.0 / M_PI, kRide_deg, 0.2 * kRide_deg);
}

TEST(RobotDriverTest, KeepsLessDistanceWhenAskedTo) {
  const Route route = laneOf("straight 200");
  const auto gapBehindAStandingCar = [&](bool close_up) {
    RobotDriver driver({}, 0.0, close_up, route, 1);
    Obstacle car;
    car.id = 7;
    const PathPoint place = route.street.at(route.start_s + 60.0);
    car.position = route.street.beside(route.start_s + 60.0, route.robot_left).head<2>();
    car.yaw = place.yaw;
    car.length = 4.0;
    car.width = 1.8;
    for (int i = 0; i < 2000; ++i) driver.advance(kDriverStep_s, {car});
    EXPECT_LT(driver.state().speed, 0.1);
    return (car.position - driver.state().obstacle.position).norm();
  };
  EXPECT_LT(gapBehindAStandingCar(true), gapBehindAStandingCar(false) - 0.3);
}

TEST(RobotDriverTest, TheSameSeedGivesTheSameRide) {
  const Route route = laneOf("straight 100");
  RobotDriver one({}, 0.3, false, route, 5), same({}, 0.3, false, route, 5),
      other({}, 0.3, false, route, 6);
  for (int i = 0; i < 100; ++i) {
    one.advance(kDriverStep_s, {});
    same.advance(kDriverStep_s, {});
    other.advance(kDriverStep_s, {});
  }
  EXPECT_EQ(one.T_world_robot().matrix(), same.T_world_robot().matrix());
  EXPECT_NE(one.T_world_robot().matrix(), other.T_world_robot().matrix());
}

}  // namespace
}  // namespace headway::sim
