#pragma once

#include <headway/core/stereo_frame.h>

#include <deque>
#include <optional>

namespace headway::io {

/// One inertial sample in the robot frame.
struct InertialSample {
  Time time = 0.0;
  std::optional<Eigen::Vector3d> angular_velocity;  ///< [rad/s]
  std::optional<Eigen::Vector3d> acceleration;      ///< specific force: +g upwards at rest [m/s^2]
};

/// What wheel odometry and inertial samples say of the motion between two frames.
///
/// Odometry is interpolated at the frames' times, the gyroscope is integrated between them, and
/// the accelerometer's mean shows up where the robot accelerates little. Nothing is extrapolated:
/// what the samples do not cover stays empty.
class MotionPriorBuilder {
 public:
  /// @param T_odom_robot  robot in the odometry's frame, in time order
  void addOdometry(Time time, const Pose& T_odom_robot);
  void addInertial(const InertialSample& sample);

  /// The motion from the frame before (none: only the direction up is told).
  [[nodiscard]] MotionPrior between(std::optional<Time> previous, Time current) const;

  /// Forgets what no later frame needs.
  void forgetBefore(Time time);

 private:
  [[nodiscard]] std::optional<Eigen::Matrix3d> turnBetween(Time previous, Time current) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> upAt(Time time) const;

  std::deque<Stamped<Pose>> odometry_;
  std::deque<Stamped<Eigen::Vector3d>> angular_velocity_;
  std::deque<Stamped<Eigen::Vector3d>> acceleration_;
};

}  // namespace headway::io
