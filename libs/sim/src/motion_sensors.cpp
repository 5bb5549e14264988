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

}  // namespace

MotionSensors::MotionSensors(std::uint64_t seed) : random_(seed) {
  gyro_bias_ = noise(kGyroBias);
  accelerometer_bias_ = noise(kAccelerometerBias);
  wheel_scale_ = 1.0 + kWheelScale * random_.normal();
}

Eigen::Vector3d MotionSensors::noise(double sigma) {
  const double x = random_.normal(), y = random_.normal(), z = random_.normal();
  return sigma * Eigen::Vector3d(x, y, z);
}

void MotionSensors::integrateWheels(const Pose& T_previous_now) {
  const double way = T_previous_now.translation().x() * wheel_scale_;
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
    integrateWheels(T_previous_now);
    const Eigen::Vector3d velocity =
        (T_world_robot.translation() - last_->value.translation()) / dt;
    if (velocity_) {
      const Eigen::Vector3d force =
          (velocity - *velocity_) / dt + Eigen::Vector3d(0.0, 0.0, kGravity);
      ImuSample sample;
      sample.time = time;
      sample.angular_velocity =
          logSo3(T_previous_now.linear()) / dt + gyro_bias_ + noise(kGyroSigma);
      sample.acceleration = T_world_robot.linear().transpose() * force + accelerometer_bias_ +
                            noise(kAccelerometerSigma);
      imu_.push_back(sample);
    }
    velocity_ = velocity;
  }
  last_ = {time, T_world_robot};
}

std::vector<ImuSample> MotionSensors::takeImu() { return std::exchange(imu_, {}); }

}  // namespace headway::sim
