// SPDX-License-Identifier: BSD-3-Clause
// What inertial sensor and wheel encoders measure, against the differentiated true motion.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robot.h"
#include "robot_sensors.h"

namespace headway::sim {
namespace {

constexpr double kSensorStep = 0.01;  // [s]

/// A robot that weaves over a hill, pitching and rolling, with analytic derivatives.
struct Weaving {
  static Eigen::Vector3d position(double t) {
    return {2.0 * t, 1.5 * std::sin(0.9 * t), 0.4 * std::sin(0.5 * t)};
  }
  static Eigen::Vector3d acceleration(double t) {
    return {0.0, -1.5 * 0.81 * std::sin(0.9 * t), -0.4 * 0.25 * std::sin(0.5 * t)};
  }
  static Eigen::Matrix3d rotation(double t) {
    return (Eigen::AngleAxisd(0.6 * std::sin(0.7 * t), Eigen::Vector3d::UnitZ()) *
            Eigen::AngleAxisd(0.1 * std::sin(1.3 * t), Eigen::Vector3d::UnitY()) *
            Eigen::AngleAxisd(0.08 * std::sin(1.1 * t), Eigen::Vector3d::UnitX()))
        .toRotationMatrix();
  }
  static Pose pose(double t) {
    Pose pose = Pose::Identity();
    pose.linear() = rotation(t);
    pose.translation() = position(t);
    return pose;
  }
  /// In the robot's own axes, by differences of a tenth of a sensor's step.
  static Eigen::Vector3d angularVelocity(double t) {
    constexpr double kTolerance = 0.001;
    return logSo3(rotation(t - kTolerance).transpose() * rotation(t + kTolerance)) /
           (2.0 * kTolerance);
  }
};

std::vector<ImuSample> samplesOf(std::uint64_t seed, double seconds) {
  MotionSensors sensors(seed);
  for (int i = 0; i * kSensorStep <= seconds; ++i)
    sensors.observe(i * kSensorStep, Weaving::pose(i * kSensorStep));
  return sensors.takeImu();
}

/// Mean and standard deviation of each axis.
struct Spread {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), deviation = Eigen::Vector3d::Zero();
};

Spread spreadOf(const std::vector<Eigen::Vector3d>& values) {
  Spread spread;
  const auto n = static_cast<double>(values.size());
  for (const auto& value : values) spread.mean += value / n;
  for (const auto& value : values) spread.deviation += (value - spread.mean).cwiseAbs2() / n;
  spread.deviation = spread.deviation.cwiseSqrt();
  return spread;
}

TEST(ImuTest, MeasuresTheTrueMotionButForBiasAndNoise) {
  std::vector<Eigen::Vector3d> turn_errors, force_errors;
  for (const ImuSample& sample : samplesOf(4, 40.0)) {
    const double t = sample.time;
    turn_errors.push_back(sample.angular_velocity - Weaving::angularVelocity(t));
    const Eigen::Vector3d force =
        Weaving::rotation(t).transpose() * (Weaving::acceleration(t) + Eigen::Vector3d(0, 0, 9.81));
    force_errors.push_back(sample.acceleration - force);
  }
  ASSERT_GT(turn_errors.size(), 3900U);
  const Spread turn = spreadOf(turn_errors), force = spreadOf(force_errors);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(turn.deviation[axis], 0.002, 2e-4);
    EXPECT_NEAR(force.deviation[axis], 0.05, 5e-3);
    EXPECT_LT(std::abs(turn.mean[axis]), 4.0 * 0.003);
    EXPECT_LT(std::abs(force.mean[axis]), 4.0 * 0.08);
  }
}

TEST(ImuTest, BiasesDifferFromSensorToSensorAndStayTheSameWithinOne) {
  std::vector<Eigen::Vector3d> turn_biases, force_biases;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    MotionSensors sensors(seed);
    for (int i = 0; i < 62; ++i) sensors.observe(i * kSensorStep, Pose::Identity());
    Eigen::Vector3d turn = Eigen::Vector3d::Zero(), force = -Eigen::Vector3d(0, 0, 9.81);
    const auto samples = sensors.takeImu();
    for (const ImuSample& sample : samples) {
      turn += sample.angular_velocity / static_cast<double>(samples.size());
      force += sample.acceleration / static_cast<double>(samples.size());
    }
    turn_biases.push_back(turn);
    force_biases.push_back(force);
  }
  const Spread turn = spreadOf(turn_biases), force = spreadOf(force_biases);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(turn.deviation[axis], 0.003, 0.0007);
    EXPECT_NEAR(force.deviation[axis], 0.08, 0.02);
    EXPECT_LT(std::abs(turn.mean[axis]), 0.001);
    EXPECT_LT(std::abs(force.mean[axis]), 0.03);
  }
}

TEST(ImuTest, ComesOnceForEachPoseBetweenTwoSteps) {
  MotionSensors sensors(1);
  EXPECT_FALSE(sensors.odometry());
  sensors.observe(5.0, Weaving::pose(0.0));
  sensors.observe(5.01, Weaving::pose(0.01));
  EXPECT_TRUE(sensors.takeImu().empty());
  sensors.observe(5.02, Weaving::pose(0.02));
  sensors.observe(5.03, Weaving::pose(0.03));
  const auto samples = sensors.takeImu();
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_DOUBLE_EQ(samples[0].time, 5.01);
  EXPECT_DOUBLE_EQ(samples[1].time, 5.02);
  EXPECT_TRUE(sensors.takeImu().empty());
  EXPECT_DOUBLE_EQ(sensors.odometry()->time, 5.03);
}

TEST(ImuTest, UnevenStepsAreNoAcceleration) {
  MotionSensors sensors(2);
  double t = 0.0;
  for (int i = 0; i < 300; ++i) {
    t += i % 3 == 0 ? 0.004 : 0.01;
    Pose pose = Pose::Identity();
    pose.translation().x() = 1.5 * t;
    sensors.observe(t, pose);
  }
  for (const ImuSample& sample : sensors.takeImu()) {
    EXPECT_NEAR(sample.acceleration.x(), 0.0, 0.6);
  }
}

TEST(OdometryTest, SlippingWheelsTurnTwiceAsFast) {
  const auto xAfter = [](double slip_ratio) {
    MotionSensors sensors(3, slip_ratio);
    for (int i = 0; i <= 1000; ++i) {
      Pose pose = Pose::Identity();
      pose.translation().x() = 0.01 * i;
      sensors.observe(i * kSensorStep, pose);
    }
    return sensors.odometry()->x;
  };
  EXPECT_NEAR(xAfter(0.25) / xAfter(0.0), 1.25, 0.02);
  EXPECT_NEAR(xAfter(1.0) / xAfter(0.0), 2.0, 0.02);
}

TEST(OdometryTest, ScaleAndHeadingDriftAsMuchAsDocumented) {
  constexpr double kWay = 40.0;  // [m], straight on
  std::vector<Eigen::Vector3d> errors;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    MotionSensors sensors(seed);
    double along = 0.0;
    OdometrySample last;
    for (int i = 0; i <= 400; ++i) {
      Pose pose = Pose::Identity();
      pose.translation().x() = kWay * i / 400.0;
      sensors.observe(0.1 * i, pose);
      const OdometrySample now = *sensors.odometry();
      along += std::hypot(now.x - last.x, now.y - last.y);
      last = now;
    }
    errors.push_back({along / kWay - 1.0, last.yaw, 0.0});
  }
  const Spread spread = spreadOf(errors);
  EXPECT_NEAR(spread.mean.x(), 0.0, 0.001);
  EXPECT_NEAR(spread.deviation.x(), 0.005, 0.0007);
  EXPECT_NEAR(spread.mean.y(), 0.0, 0.004);
  EXPECT_NEAR(spread.deviation.y(), 0.0032 * std::sqrt(kWay), 0.003) << "0.01 rad for 10 m";
}

TEST(OdometryTest, DoesNotDriftWhileTheRobotStands) {
  MotionSensors sensors(3);
  for (int i = 0; i < 1000; ++i) sensors.observe(0.01 * i, Weaving::pose(2.0));
  EXPECT_NEAR(sensors.odometry()->x, 0.0, 1e-9);
  EXPECT_NEAR(sensors.odometry()->y, 0.0, 1e-9);
  EXPECT_NEAR(sensors.odometry()->yaw, 0.0, 1e-9);
}

TEST(OdometryTest, TurnsOnTheSpotWithoutMovingAndDrivesBackwards) {
  MotionSensors sensors(4);
  for (int i = 0; i <= 100; ++i) {
    Pose pose = Pose::Identity();
    pose.linear() = expSo3({0, 0, 0.02 * i});
    sensors.observe(0.01 * i, pose);
  }
  EXPECT_NEAR(sensors.odometry()->yaw, 2.0, 1e-6);
  EXPECT_NEAR(sensors.odometry()->x, 0.0, 1e-9);
  MotionSensors backwards(4);
  for (int i = 0; i <= 100; ++i) {
    Pose pose = Pose::Identity();
    pose.translation().x() = -0.01 * i;
    backwards.observe(0.01 * i, pose);
  }
  EXPECT_NEAR(backwards.odometry()->x, -1.0, 0.03);
}

TEST(SuspensionTest, ShakesWithItsStandardDeviationAtFullSpeedAndNotAtAStandstill) {
  for (const double motion : {0.0, 0.5, 1.0}) {
    Random random(7);
    Suspension axis;
    double square = 0.0;
    constexpr int kSteps = 60000;
    for (int i = 0; i < kSteps; ++i) {
      axis.advance(kSensorStep, 0.01, motion, 0.0, random);
      square += axis.angle * axis.angle / kSteps;
    }
    EXPECT_NEAR(std::sqrt(square), 0.01 * motion, 0.15 * 0.01 * motion + 1e-12);
  }
}

TEST(SuspensionTest, ComesToRestAtTheAngleItIsPulledTo) {
  Random random(1);
  Suspension axis;
  double overshoot = 0.0;
  for (int i = 0; i < 400; ++i) {
    axis.advance(kSensorStep, 0.01, 0.0, 0.02, random);
    overshoot = std::max(overshoot, axis.angle);
  }
  EXPECT_NEAR(axis.angle, 0.02, 1e-5);
  EXPECT_NEAR(axis.rate, 0.0, 1e-4);
  EXPECT_GT(overshoot, 0.021) << "it is damped, but not dead";
  EXPECT_LT(overshoot, 0.03);
}

TEST(MotionSensorsTest, AStandingRobotMeasuresGravityAlone) {
  MotionSensors sensors(1);
  for (int i = 0; i < 400; ++i) sensors.observe(0.01 * i, Pose::Identity());
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), turn = Eigen::Vector3d::Zero();
  const auto samples = sensors.takeImu();
  for (const auto& sample : samples) {
    force += sample.acceleration / static_cast<double>(samples.size());
    turn += sample.angular_velocity / static_cast<double>(samples.size());
  }
  EXPECT_LT((force - Eigen::Vector3d(0, 0, 9.81)).norm(), 0.5);  // biases
  EXPECT_LT(turn.norm(), 0.02);
  EXPECT_TRUE(sensors.takeImu().empty());
}

TEST(MotionSensorsTest, MeasureTurningAndTheWayDriven) {
  MotionSensors sensors(2);
  constexpr double kRate = 0.3, kSpeed = 5.0;  // a circle of 16.7 m
  for (int i = 0; i <= 500; ++i) {
    const double t = 0.01 * i, yaw = kRate * t, r = kSpeed / kRate;
    Pose pose = Pose::Identity();
    pose.linear() = expSo3({0, 0, yaw});
    pose.translation() = Eigen::Vector3d(r * std::sin(yaw), r * (1 - std::cos(yaw)), 0);
    sensors.observe(t, pose);
  }
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), turn = Eigen::Vector3d::Zero();
  const auto samples = sensors.takeImu();
  ASSERT_EQ(samples.size(), 499U);
  for (const auto& sample : samples) {
    force += sample.acceleration / 499.0;
    turn += sample.angular_velocity / 499.0;
  }
  EXPECT_NEAR(turn.z(), kRate, 0.02);
  EXPECT_NEAR(force.y(), kRate * kSpeed, 0.4);
  const auto odometry = sensors.odometry();
  ASSERT_TRUE(odometry);
  const double r = kSpeed / kRate;
  EXPECT_NEAR(odometry->yaw, kRate * 5.0, 0.1);
  EXPECT_NEAR(odometry->x, r * std::sin(kRate * 5.0), 1.5);
}

TEST(MotionSensorsTest, BrakingIsMeasuredWhenItHappensInTheRobotsOwnAxes) {
  MotionSensors sensors(3);
  constexpr double kBrake = 3.0, kTop = 1.5, kYaw = 1.2;
  const auto speed = [&](double t) { return std::clamp(kTop - kBrake * (t - 1.0), 0.0, kTop); };
  double way = 0.0;
  for (int i = 0; i <= 200; ++i) {
    const double t = 0.01 * i;
    way += 0.01 * speed(t - 0.005);
    Pose pose = Pose::Identity();
    pose.linear() = expSo3({0, 0, kYaw});
    pose.translation() = way * Eigen::Vector3d(std::cos(kYaw), std::sin(kYaw), 0.0);
    sensors.observe(t, pose);
  }
  for (const auto& sample : sensors.takeImu()) {
    const bool braking = sample.time > 1.02 && sample.time < 1.48;
    const bool steady = sample.time < 0.98 || sample.time > 1.52;
    if (braking) {
      EXPECT_NEAR(sample.acceleration.x(), -kBrake, 0.5) << sample.time;
    } else if (steady) {
      EXPECT_NEAR(sample.acceleration.x(), 0.0, 0.5) << sample.time;
    }
    EXPECT_NEAR(sample.acceleration.y(), 0.0, 0.5);
    EXPECT_NEAR(sample.acceleration.z(), 9.81, 0.5);
  }
}

}  // namespace
}  // namespace headway::sim
