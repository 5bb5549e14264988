// SPDX-License-Identifier: BSD-3-Clause
// Wheel odometry between keyframes, its uncertainty, and its comparison with the camera.
#include "wheel_odometry.h"

#include <cmath>

namespace headway::slam {

namespace {

OdometryLink linkOf(const Pose& step) {
  return {{}, step, step.translation().norm(), logSo3(step.linear()).norm()};
}

}  // namespace

void KeyframeOdometry::add(const MotionPrior& prior) {
  if (!link_) return;
  if (!prior.T_previous_current) {
    link_.reset();
    return;
  }
  link_ = composed(*link_, linkOf(*prior.T_previous_current));
}

void KeyframeOdometry::restartAt(KeyframeId keyframe) {
  link_.reset();
  if (use_) link_ = OdometryLink{keyframe, Pose::Identity(), 0.0, 0.0};
}

Eigen::Matrix<double, 6, 1> sigmaOf(const OdometryLink& link) {
  constexpr WheelNoise kWheels;
  const double plane = kWheels.floor_m + kWheels.along * link.path_m;
  const double yaw = kWheels.yaw_floor_rad + kWheels.yaw_by_turn * link.turn_rad +
                     kWheels.yaw_rad_per_m * link.path_m;
  Eigen::Matrix<double, 6, 1> sigma;
  sigma << plane, plane, kWheels.floor_m + kWheels.slope_rad * link.path_m, kWheels.slope_rad,
      kWheels.slope_rad, yaw;
  return sigma;
}

PoseCovariance covarianceOf(const OdometryLink& link) {
  Eigen::Matrix<double, 6, 1> sigma = sigmaOf(link);
  sigma[1] = std::hypot(sigma[1], 0.5 * link.path_m * sigma[5]);
  return sigma.cwiseAbs2().asDiagonal();
}

namespace {

constexpr double kWindowS = 1.0;
constexpr double kMaxSigmas = 3.0;

/// The wheels' motion from one moment to a later one, both summed up from the same start.
OdometryLink between(const OdometryLink& first, const OdometryLink& second) {
  return {{},
          first.T_from_this.inverse(Eigen::Isometry) * second.T_from_this,
          second.path_m - first.path_m,
          second.turn_rad - first.turn_rad};
}

/// Standard deviations of the difference: (translation [m], rotation [rad]). A wrong direction
/// displaces half of the path.
Eigen::Matrix<double, 6, 1> differenceSigma(const OdometryLink& link, double position_sigma,
                                            double rotation_sigma) {
  Eigen::Matrix<double, 6, 1> sigma = sigmaOf(link);
  const double sideways = 0.5 * link.path_m * sigma[5];
  for (int i = 0; i < 3; ++i) {
    sigma[i] = std::hypot(sigma[i], sideways, position_sigma);
    sigma[i + 3] = std::hypot(sigma[i + 3], rotation_sigma);
  }
  return sigma;
}

/// Whether a motion is smaller than the noise of wheels that stand, times a factor.
bool isWithinNoise(const Pose& motion, double factor) {
  const Eigen::Matrix<double, 6, 1> sigma = factor * sigmaOf({});
  return motion.translation().norm() <= sigma[0] && logSo3(motion.linear()).norm() <= sigma[5];
}

}  // namespace

bool StandstillCheck::add(Time time, const MotionPrior& prior, bool is_new) {
  const double seconds = last_ ? time - *last_ : 0.0;
  last_ = time;
  if (is_new) {
    T_new_now_ = Pose::Identity();
  } else if (!prior.T_previous_current) {
    T_new_now_.reset();
  } else if (T_new_now_) {
    T_new_now_ = normalized(Pose(*T_new_now_ * *prior.T_previous_current));
  }
  return T_new_now_ && prior.T_previous_current && isWithinNoise(*T_new_now_, 1.0) &&
         isWithinNoise(*prior.T_previous_current, kMaxSigmas * seconds / kWindowS);
}

bool OdometryCheck::add(const MeasuredStep& by_camera, const MotionPrior& prior) {
  if (!prior.T_previous_current) {
    restart();
    return true;
  }
  if (window_.empty()) window_.emplace_back();
  const Moment& last = window_.back();
  window_.push_back({by_camera.time,
                     normalized(Pose(last.T_start_now * by_camera.T_previous_current)),
                     composed(last.by_wheels, linkOf(*prior.T_previous_current)),
                     by_camera.position_sigma, by_camera.rotation_sigma});
  const Moment& now = window_.back();
  while (window_.size() > 2 && now.time - window_[1].time >= kWindowS) window_.pop_front();
  const Moment& start = window_.front();
  const OdometryLink wheels = between(start.by_wheels, now.by_wheels);
  const Pose camera = start.T_start_now.inverse(Eigen::Isometry) * now.T_start_now;
  const Pose difference = wheels.T_from_this.inverse(Eigen::Isometry) * camera;
  Eigen::Matrix<double, 6, 1> error;
  error << difference.translation(), logSo3(difference.linear());
  const auto sigma = differenceSigma(wheels, std::hypot(start.position_sigma, now.position_sigma),
                                     std::hypot(start.rotation_sigma, now.rotation_sigma));
  return (error.array().abs() <= kMaxSigmas * sigma.array()).all();
}

}  // namespace headway::slam
