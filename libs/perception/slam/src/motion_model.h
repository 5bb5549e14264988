// SPDX-License-Identifier: BSD-3-Clause
// Prediction of the next pose, and the composition of its covariance.
#pragma once

#include <headway/core/pose.h>
#include <headway/core/stereo_frame.h>
#include <headway/slam/slam_params.h>

#include <algorithm>
#include <optional>

namespace headway::slam {

/// Covariance of T_a_c = T_a_b T_b_c from those of its factors, whose errors are independent.
///
/// @param T_b_c  with the covariance `of_bc`; a pose that is exactly known has covariance 0
/// @see          Barfoot & Furgale 2014, first order; perturbations act on the right
[[nodiscard]] PoseCovariance composedCovariance(const PoseCovariance& of_ab, const Pose& T_b_c,
                                                const PoseCovariance& of_bc);

/// Covariance of a camera's pose in its map by what is not known of the calibration: a focal length
/// that is off scales the rotation and the way since the map's origin, a baseline or an offset of
/// disparities the way. First order, as if the camera had turned first and both were independent;
/// on the right as composedCovariance().
///
/// @param T_origin_cam  since the map's first keyframe; a loop that closes there leaves nothing
/// @param offset_ratio  standard deviation of the offset by the disparity of what is seen
[[nodiscard]] PoseCovariance calibrationCovariance(const Pose& T_origin_cam, double offset_ratio);

/// Standard deviation of a position, mean of the axes [m].
[[nodiscard]] double positionSigma(const PoseCovariance& covariance);

/// Standard deviation of a rotation, mean of the axes [rad].
[[nodiscard]] double rotationSigma(const PoseCovariance& covariance);

/// Predicts the next pose: by wheel odometry, else at constant velocity, turned by the gyroscope.
class MotionModel {
 public:
  static constexpr double kMaxGap_s = 1.0;  ///< longest extrapolation of a velocity

  MotionModel(const Pose& T_robot_cam, const SlamParams& params)
      : T_robot_cam_(T_robot_cam), params_(params) {}

  /// Starts at the first frame of a map: the robot is its origin, its yaw is zero.
  ///
  /// @param up_robot  unit vector against gravity, robot frame
  void initialise(Time time, const Eigen::Vector3d& up_robot);
  [[nodiscard]] bool isStarted() const { return started_; }
  /// From now on without the gyroscope, which is wrong.
  void disableImu() { params_.use_imu = false; }
  /// Predicted camera pose at a frame; the last pose where the motion is unknown.
  [[nodiscard]] Pose predict(const StereoFrame& frame) const;
  /// The last pose known (identity before the first one).
  [[nodiscard]] const Pose& last() const { return last_.value; }
  /// Time from the last pose, not negative [s].
  [[nodiscard]] double secondsTo(Time time) const { return std::max(0.0, time - last_.time); }

  /// A pose that was measured: its difference to the last one is the new velocity.
  void update(Time time, const Pose& T_map_cam);
  /// Sets a pose that was only predicted: the velocity falls to zero within kMaxGap_s of the last
  /// measured pose.
  void coast(Time time, const Pose& T_map_cam);
  /// The last pose was corrected; the velocity, as seen from the camera, stays.
  void correct(const Pose& T_map_cam) { last_.value = T_map_cam; }
  /// The camera is mounted otherwise.
  void remount(const Pose& T_robot_cam) { T_robot_cam_ = T_robot_cam; }
  /// Restarts at a pose with zero velocity.
  void reset(Time time, const Pose& T_map_cam);

 private:
  Pose T_robot_cam_ = Pose::Identity();
  SlamParams params_;
  Stamped<Pose> last_{0.0, Pose::Identity()};
  bool started_ = false;
  Time measured_ = 0.0;  ///< time of the last pose that was measured [s]
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();          ///< camera frame [m/s]
  Eigen::Vector3d angular_velocity_ = Eigen::Vector3d::Zero();  ///< camera frame [rad/s]
};

}  // namespace headway::slam
