// SPDX-License-Identifier: BSD-3-Clause
// Gravity by the inertial sensor: its estimate, the levelling of the map, and the test of the
// sensor against the camera.
#include "inertial_alignment.h"

#include <headway/core/statistics.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace headway::slam {
namespace {

constexpr InertialNoise kNoise;
constexpr double kGravity = 9.80665;         // standard gravity [m/s^2]
constexpr double kExpectedInnovation = 3.0;  // its degrees of freedom

}  // namespace

GravityEstimator::GravityEstimator(double sigma_tilt_rad) : innovation_(kExpectedInnovation) {
  state_.head<3>() = kGravity * Eigen::Vector3d::UnitZ();
  State sigmas;
  const double sigma_xy = kGravity * sigma_tilt_rad;
  sigmas << sigma_xy, sigma_xy, kNoise.gravity, Eigen::Vector3d::Constant(kNoise.bias),
      Eigen::Vector3d::Constant(kNoise.velocity);
  covariance_ = sigmas.cwiseAbs2().asDiagonal();
}

void GravityEstimator::add(const CameraStep& step, const Eigen::Vector3d& velocity_increment) {
  update(step, velocity_increment);
  predict(step, velocity_increment);
}

/// The camera's mean velocity over the step: the initial one and half of its change.
void GravityEstimator::update(const CameraStep& step, const Eigen::Vector3d& velocity_increment) {
  constexpr double kWindow_s = 2.0;      // of the mean innovation
  constexpr double kMaxCounted = 100.0;  // one jump of the camera is no contradiction
  const double dt = step.seconds;
  const Eigen::Matrix3d R_robot_map = step.T_map_previous.linear().transpose();
  Eigen::Matrix<double, 3, 9> H;
  H << -0.5 * dt * R_robot_map, -0.5 * dt * Eigen::Matrix3d::Identity(),
      Eigen::Matrix3d::Identity();
  const Eigen::Vector3d moved = step.T_previous_current.translation();
  const Eigen::Vector3d innovation = moved / dt - 0.5 * velocity_increment - H * state_;
  const double sigma =
      (kNoise.common_errors * step.sigma_m + kNoise.step_ratio * moved.norm()) / dt;
  const Eigen::Matrix3d predicted = H * covariance_ * H.transpose();
  Eigen::Matrix3d noise = sigma * sigma * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d S = predicted + noise;
  const double normalised = innovation.dot(S.inverse() * innovation);
  innovation_ += (std::min(normalised, kMaxCounted) - innovation_) * std::min(1.0, dt / kWindow_s);
  noise *=
      std::max(1.0, normalised / (3.0 * kExpectedInnovation));  // robust against single wrong poses
  const Eigen::Matrix<double, 9, 3> gain =
      covariance_ * H.transpose() * Eigen::Matrix3d(predicted + noise).inverse();
  state_ += gain * innovation;
  const Covariance kept = Covariance::Identity() - gain * H;  // Joseph's form stays positive
  covariance_ = kept * covariance_ * kept.transpose() + gain * noise * gain.transpose();
}

void GravityEstimator::predict(const CameraStep& step, const Eigen::Vector3d& velocity_increment) {
  const double dt = step.seconds;
  const Eigen::Matrix3d R_robot_map = step.T_map_previous.linear().transpose();
  const Eigen::Matrix3d R_current_previous = step.T_previous_current.linear().transpose();
  Covariance F = Covariance::Identity();
  F.block<3, 3>(6, 0) = -dt * R_current_previous * R_robot_map;
  F.block<3, 3>(6, 3) = -dt * R_current_previous;
  F.block<3, 3>(6, 6) = R_current_previous;
  state_ = F * state_;
  state_.tail<3>() += R_current_previous * velocity_increment;
  covariance_ = F * covariance_ * F.transpose();
  const double rate = logSo3(step.T_previous_current.linear()).norm() / dt;
  const double lever = kNoise.lever_arm_m * rate * rate * dt;  // centripetal
  const double velocity_variance = kNoise.force * kNoise.force * dt + lever * lever;
  covariance_.diagonal().segment<3>(3).array() += kNoise.bias_walk * kNoise.bias_walk * dt;
  covariance_.diagonal().tail<3>().array() += velocity_variance;
}

void GravityEstimator::resetVelocity() {
  covariance_.rightCols<3>().setZero();
  covariance_.bottomRows<3>().setZero();
  covariance_.diagonal().tail<3>().setConstant(kNoise.velocity * kNoise.velocity);
  state_.tail<3>().setZero();
}

void GravityEstimator::rotate(const Eigen::Matrix3d& rotation) {
  Covariance F = Covariance::Identity();
  F.topLeftCorner<3, 3>() = rotation;
  state_ = F * state_;
  covariance_ = F * covariance_ * F.transpose();
}

Eigen::Matrix2d GravityEstimator::tiltCovariance() const {
  return covariance_.topLeftCorner<2, 2>() / state_.head<3>().squaredNorm();
}

double GravityEstimator::tiltSigma() const {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(tiltCovariance(),
                                                              Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()(1)));
}

double GravityEstimator::normalisedTilt() const {
  const Eigen::Vector2d tilt = up().head<2>();
  return tilt.dot(tiltCovariance().inverse() * tilt);
}

bool GravityEstimator::isContradictory() const { return innovation_ > 10.0 * kExpectedInnovation; }

namespace {

constexpr LevellingParams kLevelling;
constexpr GyroscopeLimits kLimits;

double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

void GyroscopeCheck::add(const Eigen::Matrix3d& by_gyroscope, const Eigen::Matrix3d& by_camera,
                         double seconds) {
  const double turn = std::max(logSo3(by_gyroscope).norm(), logSo3(by_camera).norm());
  if (turn <= kLimits.max_bias * seconds + 2.0 * kLimits.camera_sigma_rad) return;
  turned_rad_ += turn;
  differed_rad_ += logSo3(by_gyroscope.transpose() * by_camera).norm();
  if (turned_rad_ > kLimits.window_rad) {
    turned_rad_ *= 0.5;
    differed_rad_ *= 0.5;
  }
}

bool GyroscopeCheck::isContradictory() const {
  return turned_rad_ > kLimits.enough_rad && differed_rad_ > 0.5 * turned_rad_;
}

Eigen::Vector3d InertialAlignment::initialUp(
    const MotionPrior& prior, const std::function<std::optional<Eigen::Vector3d>()>& up_ground) {
  gravity_ = GravityEstimator(kLevelling.mount_sigma_rad);
  const Eigen::Vector3d mounted = Eigen::Vector3d::UnitZ();
  if (!prior.specific_force) return mounted;
  if (!prior.specific_force->allFinite() || prior.specific_force->isZero()) {
    status_ = ImuStatus::kAccelerometerContradicts;
    return mounted;
  }
  status_ = ImuStatus::kUsed;
  if (angleBetween(*prior.specific_force, mounted) <= kLevelling.max_mount_tilt_rad) return mounted;
  const auto ground = up_ground();
  if (ground && angleBetween(*ground, mounted) < kLevelling.max_ground_tilt_rad) {
    status_ = ImuStatus::kAccelerometerContradicts;
    return mounted;
  }
  gravity_ = GravityEstimator(kLevelling.upright_sigma_rad);
  return prior.specific_force->normalized();
}

std::optional<Eigen::Matrix3d> InertialAlignment::add(const CameraStep& step,
                                                      const MotionPrior& prior) {
  if (isLeftOut() || step.seconds <= 0.0) return std::nullopt;
  if (prior.R_previous_current) {
    status_ = ImuStatus::kUsed;
    gyroscope_.add(*prior.R_previous_current, step.T_previous_current.linear(), step.seconds);
    if (gyroscope_.isContradictory()) return leaveOut(ImuStatus::kGyroscopeContradicts);
  }
  if (!prior.velocity_increment) {
    gravity_.resetVelocity();
    return std::nullopt;
  }
  gravity_.add(step, *prior.velocity_increment);
  observed_s_ += step.seconds;
  if (gravity_.isContradictory()) return leaveOut(ImuStatus::kAccelerometerContradicts);
  if (observed_s_ > kLevelling.period_s || !isTilted()) return std::nullopt;
  const Eigen::Matrix3d rotation =
      Eigen::Quaterniond::FromTwoVectors(gravity_.up(), Eigen::Vector3d::UnitZ())
          .toRotationMatrix();
  gravity_.rotate(rotation);
  levelled_ = rotation * levelled_;
  return rotation;
}

/// The mount is exact unless gravity refutes it, because most robots stand on level floors and an
/// accelerometer's bias is half a degree.
bool InertialAlignment::isTilted() const {
  if (levelled_.isIdentity()) return gravity_.normalisedTilt() > chiSquare99(2);
  const double tilt = angleBetween(gravity_.up(), Eigen::Vector3d::UnitZ());
  return tilt > std::max(0.1 * kDegree, 0.5 * gravity_.tiltSigma());
}

bool InertialAlignment::isLeftOut() const {
  return status_ == ImuStatus::kGyroscopeContradicts ||
         status_ == ImuStatus::kAccelerometerContradicts;
}

/// Also takes back what the sensor has turned so far.
std::optional<Eigen::Matrix3d> InertialAlignment::leaveOut(ImuStatus reason) {
  status_ = reason;
  if (levelled_.isIdentity()) return std::nullopt;
  return Eigen::Matrix3d(levelled_.transpose());
}

}  // namespace headway::slam
