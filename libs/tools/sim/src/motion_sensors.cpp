// SPDX-License-Identifier: BSD-3-Clause
#include "motion_sensors.h"

#include <cmath>
#include <utility>

namespace headway::sim {
namespace {

constexpr double kGravity = 9.81;                                        // [m/s^2]
constexpr double kGyroSigma = 0.002, kGyroBias = 0.003;                  // [rad/s]
constexpr double kAccelerometerSigma = 0.05, kAccelerometerBias = 0.08;  // [m/s^2]
constexpr double kWheelScale = 0.005;
constexpr double kHeadingSigma = 0.0032;  // [rad/sqrt(m)]
constexpr double kSlipPeriod = 2.0;       // [s]
constexpr double kSlipSpeed = 2.0;        // of slipping wheels, times the robot's

}  // namespace

MotionSensors::MotionSensors(std::uint64_t seed, double slip_ratio)
    : random_(seed), slip_ratio_(slip_ratio) {
  gyro_bias_ = noise(kGyroBias);
  accelerometer_bias_ = noise(kAccelerometerBias);
  wheel_scale_ = 1.0 + kWheelScale * random_.normal();
}

Eigen::Vector3d MotionSensors::noise(double sigma) {
  const double x = random_.normal(), y = random_.normal(), z = random_.normal();
  return sigma * Eigen::Vector3d(x, y, z);
}

void MotionSensors::integrateWheels(Time time, const Pose& T_previous_now) {
  const bool slips = std::fmod(time, kSlipPeriod) >= (1.0 - slip_ratio_) * kSlipPeriod;
  const double way = T_previous_now.translation().x() * wheel_scale_ * (slips ? kSlipSpeed : 1.0);
  const double turn =
      yawOf(T_previous_now) + kHeadingSigma * std::sqrt(std::abs(way)) * random_.normal();
  odometry_->x += way * std::cos(odometry_->yaw + 0.5 * turn);
  odometry_->y += way * std::sin(odometry_->yaw + 0.5 * turn);
  odometry_->yaw = wrapAngle(odometry_->yaw + turn);
}

void MotionSensors::observe(Time time, const Pose& T_world_robot) {
  if (!odometry_) odometry_ = OdometrySample{};
  odometry_->time = time;
  if (last_) {
    const double dt = time - last_->time;
    const Pose T_previous_now = last_->value.inverse() * T_world_robot;
    integrateWheels(time, T_previous_now);
    const Step step{dt, logSo3(T_previous_now.linear()) / dt,
                    (T_world_robot.translation() - last_->value.translation()) / dt};
    if (step_) imu_.push_back(sampleBetween(*step_, step));
    step_ = step;
  }
  last_ = {time, T_world_robot};
}

ImuSample MotionSensors::sampleBetween(const Step& before, const Step& after) {
  // Central differences: what is true at the pose between the two steps, in its own axes.
  const double dt = 0.5 * (before.duration_s + after.duration_s);
  const Eigen::Vector3d force =
      (after.velocity - before.velocity) / dt + Eigen::Vector3d(0.0, 0.0, kGravity);
  ImuSample sample;
  sample.time = last_->time;
  sample.angular_velocity =
      0.5 * (before.angular_velocity + after.angular_velocity) + gyro_bias_ + noise(kGyroSigma);
  sample.acceleration =
      last_->value.linear().transpose() * force + accelerometer_bias_ + noise(kAccelerometerSigma);
  return sample;
}

std::vector<ImuSample> MotionSensors::takeImu() { return std::exchange(imu_, {}); }

}  // namespace headway::sim
