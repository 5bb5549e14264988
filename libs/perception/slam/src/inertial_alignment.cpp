// SPDX-License-Identifier: BSD-3-Clause
#include "inertial_alignment.h"

#include <algorithm>
#include <cmath>

namespace headway::slam {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kMountSigma = 3.0 * kDegree;  // slopes and suspension of a robot at its start
constexpr double kMaxMountTilt =
    20.0 * kDegree;  // beyond: more than a robot's acceleration explains
constexpr double kUprightSigma = 10.0 * kDegree;  // of the accelerometer alone, in any motion
constexpr double kMaxGroundTilt = 10.0 * kDegree;
// Later a tilt is the drift of the camera's path, which is no reason to turn the whole map.
constexpr double kLevelling = 30.0;  // [s]

double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

void GyroscopeCheck::add(const Eigen::Matrix3d& by_gyroscope, const Eigen::Matrix3d& by_camera,
                         double seconds) {
  constexpr double kMaxBias = 0.05;       // of a gyroscope [rad/s]
  constexpr double kCameraSigma = 0.002;  // of the camera's turn between two frames [rad]
  constexpr double kWindow = 2.0;         // turns in the comparison [rad]
  const double turn = std::max(logSo3(by_gyroscope).norm(), logSo3(by_camera).norm());
  if (turn <= kMaxBias * seconds + 2.0 * kCameraSigma) return;
  turned_rad_ += turn;
  differed_rad_ += logSo3(by_gyroscope.transpose() * by_camera).norm();
  if (turned_rad_ > kWindow) {
    turned_rad_ *= 0.5;
    differed_rad_ *= 0.5;
  }
}

bool GyroscopeCheck::isContradictory() const {
  constexpr double kEnough = 0.2;  // [rad]
  return turned_rad_ > kEnough && differed_rad_ > 0.5 * turned_rad_;
}

Eigen::Vector3d InertialAlignment::initialUp(
    const MotionPrior& prior, const std::function<std::optional<Eigen::Vector3d>()>& up_ground) {
  gravity_ = GravityEstimator(kMountSigma);
  const Eigen::Vector3d mounted = Eigen::Vector3d::UnitZ();
  if (!prior.specific_force) return mounted;
  if (!prior.specific_force->allFinite() || prior.specific_force->isZero()) {
    status_ = ImuStatus::kAccelerometerContradicts;
    return mounted;
  }
  status_ = ImuStatus::kUsed;
  if (angleBetween(*prior.specific_force, mounted) <= kMaxMountTilt) return mounted;
  const auto ground = up_ground();
  if (ground && angleBetween(*ground, mounted) < kMaxGroundTilt) {
    status_ = ImuStatus::kAccelerometerContradicts;
    return mounted;
  }
  gravity_ = GravityEstimator(kUprightSigma);
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
  if (observed_s_ > kLevelling || !isTilted()) return std::nullopt;
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
  constexpr double kChiSquared = 9.21;  // two degrees of freedom, 1 %
  if (levelled_.isIdentity()) return gravity_.normalisedTilt() > kChiSquared;
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
