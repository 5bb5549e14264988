// SPDX-License-Identifier: BSD-3-Clause
#include "inertial_alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace headway::slam {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kDt = 1.0 / 15.0;

/// A robot's course: it accelerates for 2 s, then drives a curve; the ground may be sloped.
struct Course {
  double slope_rad = 0.0;                          ///< about the y axis of the map
  double acceleration = 1.0;                       ///< for the first two seconds [m/s^2]
  double turn_rate = 0.5;                          ///< after three seconds [rad/s]
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  ///< of the accelerometer [m/s^2]

  [[nodiscard]] double speed(double t) const { return acceleration * std::min(t, 2.0); }
  [[nodiscard]] double yaw(double t) const { return turn_rate * std::max(0.0, t - 3.0); }
  /// In the map, whose z axis is the ground's normal.
  [[nodiscard]] Pose pose(double t) const {
    constexpr int kSteps = 200;
    Pose result = Pose::Identity();
    for (int i = 0; i < kSteps; ++i) {
      const double at = t * (i + 0.5) / kSteps;
      result.translation() +=
          t / kSteps * speed(at) * Eigen::Vector3d(std::cos(yaw(at)), std::sin(yaw(at)), 0.0);
    }
    result.linear() = expSo3({0.0, 0.0, yaw(t)});
    return result;
  }
  [[nodiscard]] Eigen::Vector3d up() const {
    return expSo3({0.0, slope_rad, 0.0}) * Eigen::Vector3d::UnitZ();
  }
  [[nodiscard]] Eigen::Vector3d forceInMap(double t) const {
    constexpr double kStep = 1e-3;
    const auto velocity = [&](double at) {
      return Eigen::Vector3d(speed(at) * std::cos(yaw(at)), speed(at) * std::sin(yaw(at)), 0.0);
    };
    const Eigen::Vector3d change = velocity(t + kStep) - velocity(t - kStep);
    return change / (2.0 * kStep) + 9.80665 * up();
  }
  [[nodiscard]] Eigen::Vector3d force(double t) const {
    return pose(t).linear().transpose() * forceInMap(t) + bias;
  }
};

/// What is left of the tilt after some time, with noise of a fixed seed [rad].
struct Drive {
  InertialAlignment alignment;
  Eigen::Matrix3d levelled = Eigen::Matrix3d::Identity();
  int turns = 0;
  unsigned seed = 5;
  double step_noise_m = 0.003;
  double sigma_m = 0.001;  ///< as the pose refinement states it

  /// @param distort  of the measured prior
  template <typename Distort>
  void drive(const Course& course, double seconds, Distort distort) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const auto noise = [&](double sigma) {
      return Eigen::Vector3d(sigma * normal(random), sigma * normal(random),
                             sigma * normal(random));
    };
    for (int i = 1; i * kDt < seconds; ++i) {
      const double before = (i - 1) * kDt;
      MotionPrior prior;
      Eigen::Vector3d increment = Eigen::Vector3d::Zero();
      constexpr int kSamples = 7;
      for (int j = 0; j < kSamples; ++j) {
        const double t = before + kDt * (j + 0.5) / kSamples;
        increment += kDt / kSamples *
                     (course.pose(before).linear().transpose() * course.pose(t).linear() *
                      (course.force(t) + noise(0.1)));
      }
      prior.velocity_increment = increment;
      const Pose turned = course.pose(before).inverse() * course.pose(i * kDt);
      prior.R_previous_current = expSo3(noise(0.0005)) * turned.linear();
      distort(prior);
      Pose T_map_previous = course.pose(before);
      T_map_previous = Pose(levelled) * T_map_previous;
      Pose step = turned;
      step.translation() += noise(step_noise_m);
      if (const auto rotation = alignment.add({kDt, T_map_previous, step, sigma_m}, prior)) {
        levelled = *rotation * levelled;
        ++turns;
      }
    }
  }
  void drive(const Course& course, double seconds) {
    drive(course, seconds, [](MotionPrior&) {});
  }
  [[nodiscard]] double tilt(const Course& course) const {
    const Eigen::Vector3d up = levelled * course.up();
    return std::atan2(up.head<2>().norm(), up.z());
  }
};

std::optional<Eigen::Vector3d> noGround() { return std::nullopt; }

Drive started() {
  Drive run;
  MotionPrior first;
  first.specific_force = Eigen::Vector3d(0.0, 0.0, 9.8);
  EXPECT_EQ(run.alignment.initialUp(first, noGround), Eigen::Vector3d::UnitZ());
  return run;
}

TEST(InertialAlignmentTest, AnAccelerationIsNoTilt) {
  for (const double acceleration : {-1.5, 1.0, 3.0}) {
    Course course;
    course.acceleration = acceleration;
    Drive run = started();
    run.drive(course, 10.0);
    EXPECT_EQ(run.turns, 0) << acceleration;
    EXPECT_EQ(run.alignment.status(), ImuStatus::kUsed);
  }
}

/// Without the noise in the model, 0.01 m of it between frames tilted the map within a second.
TEST(InertialAlignmentTest, TheNoiseOfAShortBaselineIsNoTilt) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    Course course;
    course.acceleration = 1.5;
    Drive run = started();
    run.seed = seed;
    run.step_noise_m = 0.01;
    run.sigma_m = 0.0033;
    run.drive(course, 2.0);
    EXPECT_EQ(run.turns, 0) << seed;
  }
}

TEST(InertialAlignmentTest, FindsASlopeAfterASecondWhateverTheMotion) {
  for (const double acceleration : {0.0, -1.0, 2.0}) {
    for (const double slope : {4.0, -8.0}) {
      Course course;
      course.slope_rad = slope * kDegree;
      course.acceleration = acceleration;
      Drive run = started();
      run.drive(course, 1.0);
      EXPECT_LT(run.tilt(course), 1.0 * kDegree) << acceleration << " " << slope;
      run = started();
      run.drive(course, 12.0);
      EXPECT_LT(run.tilt(course), 0.7 * kDegree) << acceleration << " " << slope;
    }
  }
}

TEST(InertialAlignmentTest, TurningSeparatesTheBiasFromATilt) {
  Course course;
  course.bias = {0.15, -0.1, 0.1};
  Drive run = started();
  run.drive(course, 15.0);
  EXPECT_LT(run.tilt(course), 0.3 * kDegree);
}

TEST(InertialAlignmentTest, ASensorThatIsNotUprightOnItsRobotGivesTheVertical) {
  MotionPrior first;
  first.specific_force = Eigen::Vector3d(9.7, 0.5, 0.3);
  InertialAlignment drone;
  EXPECT_TRUE(drone.initialUp(first, noGround).isApprox(first.specific_force->normalized()));
  EXPECT_EQ(drone.status(), ImuStatus::kUsed);
}

TEST(InertialAlignmentTest, GroundThatAgreesWithTheMountRefutesTheSensor) {
  MotionPrior first;
  first.specific_force = Eigen::Vector3d(9.7, 0.5, 0.3);
  InertialAlignment robot;
  const auto ground = [] { return std::optional(Eigen::Vector3d(0.05, 0.0, 1.0).normalized()); };
  EXPECT_EQ(robot.initialUp(first, ground), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(robot.status(), ImuStatus::kAccelerometerContradicts);
}

TEST(InertialAlignmentTest, LeavesOutAGyroscopeWithWrongAxes) {
  const Course course;
  Drive run = started();
  run.drive(course, 6.0, [](MotionPrior& prior) {
    const Eigen::Vector3d turn = logSo3(*prior.R_previous_current);
    prior.R_previous_current = expSo3({turn.z(), turn.x(), turn.y()});
  });
  EXPECT_EQ(run.alignment.status(), ImuStatus::kGyroscopeContradicts);
  EXPECT_LT(run.tilt(course), 1e-9);
}

TEST(InertialAlignmentTest, LeavesOutAnAccelerometerThatIsConstantOrZero) {
  for (const double constant : {0.0, 4.0, 30.0}) {
    const Course course;
    Drive run = started();
    run.drive(course, 6.0, [&](MotionPrior& prior) {
      prior.velocity_increment = kDt * Eigen::Vector3d(0.0, 0.0, constant);
    });
    EXPECT_EQ(run.alignment.status(), ImuStatus::kAccelerometerContradicts) << constant;
    EXPECT_LT(run.tilt(course), 1e-9) << constant;
  }
}

TEST(InertialAlignmentTest, LeavesOutAnAccelerometerWithWrongAxes) {
  const Course course;
  Drive run = started();
  run.drive(course, 4.0, [](MotionPrior& prior) {
    const Eigen::Vector3d v = *prior.velocity_increment;
    prior.velocity_increment = Eigen::Vector3d(v.z(), v.x(), v.y());
  });
  EXPECT_EQ(run.alignment.status(), ImuStatus::kAccelerometerContradicts);
  EXPECT_LT(run.tilt(course), 1e-9);
}

}  // namespace
}  // namespace headway::slam
