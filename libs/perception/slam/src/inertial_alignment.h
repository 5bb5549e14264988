// SPDX-License-Identifier: BSD-3-Clause
// Gravity by the inertial sensor: its estimate, the levelling of the map, and the test of the
// sensor against the camera.
#pragma once

#include <headway/core/pose.h>
#include <headway/core/stereo_frame.h>
#include <headway/slam/stereo_slam.h>

#include <functional>
#include <optional>

namespace headway::slam {

/// The camera's motion between two tracked frames.
struct CameraStep {
  double seconds = 0.0;                        ///< > 0 [s]
  Pose T_map_previous = Pose::Identity();      ///< robot
  Pose T_previous_current = Pose::Identity();  ///< robot, by the camera
  double sigma_m = 0.0;  ///< of its translation, per axis, given the landmarks [m]
};

/// Errors of an inertial sensor and of the motion by camera that it is compared with.
struct InertialNoise {
  double gravity = 0.03;     ///< over the Earth's surface [m/s^2]
  double bias = 0.1;         ///< of a MEMS accelerometer [m/s^2]
  double bias_walk = 0.002;  ///< [m/s^2/sqrt(s)]
  double force = 0.05;       ///< white noise with vibration [m/s^2/sqrt(Hz)]
  double lever_arm_m = 0.3;  ///< of the sensor from the robot's origin, which is not known
  double velocity = 30.0;    ///< before the first step [m/s]
  /// Errors of the landmarks' depths are common to the points of a frame, so that its pose is less
  /// accurate than its residuals show, most of all with a short baseline.
  double common_errors = 3.0;
  double step_ratio = 0.01;  ///< of the step's length: scale of the map
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

/// When the gyroscope contradicts the camera.
struct GyroscopeLimits {
  double max_bias = 0.05;           ///< of a gyroscope: a rotation below it tells nothing [rad/s]
  double camera_sigma_rad = 0.002;  ///< of the camera's rotation between two frames
  double window_rad = 2.0;          ///< rotations in the comparison; older ones count half
  double enough_rad = 0.2;          ///< of rotations for a contradiction
};

/// Compares the gyroscope's rotations with the camera's.
class GyroscopeCheck {
 public:
  void add(const Eigen::Matrix3d& by_gyroscope, const Eigen::Matrix3d& by_camera, double seconds);
  [[nodiscard]] bool isContradictory() const;

 private:
  double turned_rad_ = 0.0;
  double differed_rad_ = 0.0;
};

/// When the map is levelled by the inertial sensor.
struct LevellingParams {
  double mount_sigma_rad = 3.0 * kDegree;       ///< slopes and suspension of a robot at its start
  double max_mount_tilt_rad = 20.0 * kDegree;   ///< more than a robot's acceleration explains
  double upright_sigma_rad = 10.0 * kDegree;    ///< of the accelerometer alone, in any motion
  double max_ground_tilt_rad = 10.0 * kDegree;  ///< of the ground against a robot that stands on it
  /// Later a tilt is the drift of the camera's path, which is no reason to turn the whole map.
  double period_s = 30.0;
};

/// Levels the map by the inertial sensor, and leaves out one that contradicts the camera.
///
/// The accelerometer cannot tell a tilt from an acceleration or from its bias at once. So a map
/// starts level as the robot is mounted, unless the robot's axes are clearly not upright, and is
/// levelled once gravity is observable and differs significantly; from then on it follows gravity's
/// estimate.
class InertialAlignment {
 public:
  /// Direction against gravity in the robot frame at the first frame of a map.
  ///
  /// @param up_ground  normal of the ground in the robot frame where it is seen; asked for only
  ///                   where mount and accelerometer differ
  [[nodiscard]] Eigen::Vector3d initialUp(
      const MotionPrior& prior, const std::function<std::optional<Eigen::Vector3d>()>& up_ground);

  /// Takes a tracked frame after a tracked one.
  ///
  /// @return      rotation that levels the map; nullopt while it is level
  [[nodiscard]] std::optional<Eigen::Matrix3d> add(const CameraStep& step,
                                                   const MotionPrior& prior);

  /// The camera was lost.
  void interrupt() { gravity_.resetVelocity(); }
  /// The map was levelled by other means.
  void rotateMap(const Eigen::Matrix3d& rotation) {
    gravity_.rotate(rotation);
    levelled_.setIdentity();
  }

  [[nodiscard]] ImuStatus status() const { return status_; }
  /// Whether the sensor contradicts the camera.
  [[nodiscard]] bool isLeftOut() const;

 private:
  [[nodiscard]] bool isTilted() const;
  [[nodiscard]] std::optional<Eigen::Matrix3d> leaveOut(ImuStatus reason);

  GravityEstimator gravity_{0.0};
  GyroscopeCheck gyroscope_;
  ImuStatus status_ = ImuStatus::kAbsent;
  double observed_s_ = 0.0;                                 ///< time of all steps
  Eigen::Matrix3d levelled_ = Eigen::Matrix3d::Identity();  ///< product of all rotations
};

}  // namespace headway::slam
