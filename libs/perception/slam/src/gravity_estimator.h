// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

namespace headway::slam {

/// The camera's motion between two tracked frames.
struct CameraStep {
  double seconds = 0.0;                        ///< > 0 [s]
  Pose T_map_previous = Pose::Identity();      ///< robot
  Pose T_previous_current = Pose::Identity();  ///< robot, by the camera
  double sigma_m = 0.0;  ///< of its translation, per axis, given the landmarks [m]
};

/// Estimates gravity in the map from the accelerometer and the camera's own motion.
///
/// A Kalman filter over the specific force of rest (upwards, map frame), the accelerometer's bias
/// and the velocity (robot frame). Stereo gives the metric motion, so the model is linear: the
/// velocity changes by the measured specific force less bias and gravity, and the camera measures
/// its mean between two frames. The bias is told from a tilt once the robot has turned.
///
/// @see Qin, Li & Shen 2018 (VINS-Mono), section V-B; Martinelli 2014, Closed-form solution of
///      visual-inertial structure from motion
class GravityEstimator {
 public:
  /// @param sigma_tilt_rad  of the map's z axis against the vertical, before the first step
  explicit GravityEstimator(double sigma_tilt_rad);

  /// @param velocity_increment  by the accelerometer, as in MotionPrior [m/s]
  void add(const CameraStep& step, const Eigen::Vector3d& velocity_increment);
  /// The camera was lost: its velocity is unknown again.
  void resetVelocity();
  /// The map was turned: T_map_robot became rotation * T_map_robot.
  void rotate(const Eigen::Matrix3d& rotation);

  /// Unit vector against gravity, map frame.
  [[nodiscard]] Eigen::Vector3d up() const { return state_.head<3>().normalized(); }
  /// Standard deviation of the tilt, the larger of both axes [rad].
  [[nodiscard]] double tiltSigma() const;
  /// Squared Mahalanobis distance of the map's z axis from the vertical, two degrees of freedom.
  [[nodiscard]] double normalisedTilt() const;
  /// Whether accelerometer and camera contradict each other: one of them is wrong.
  [[nodiscard]] bool isContradictory() const;

 private:
  using State = Eigen::Matrix<double, 9, 1>;  ///< specific force of rest, bias, velocity
  using Covariance = Eigen::Matrix<double, 9, 9>;
  void update(const CameraStep& step, const Eigen::Vector3d& velocity_increment);
  void predict(const CameraStep& step, const Eigen::Vector3d& velocity_increment);
  [[nodiscard]] Eigen::Matrix2d tiltCovariance() const;

  State state_ = State::Zero();
  Covariance covariance_ = Covariance::Zero();
  double innovation_ = 0.0;  ///< running mean of the normalised innovation squared
};

}  // namespace headway::slam
