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

/// Computes motion priors between frames from wheel odometry and inertial samples.
///
/// Odometry is interpolated at the frames' times; gyroscope and accelerometer are integrated
/// between them. Without extrapolation: quantities that are not covered by samples remain empty.
class MotionPriorBuilder {
 public:
  /// @param T_odom_robot  robot in the odometry's frame, in time order
  void addOdometry(Time time, const Pose& T_odom_robot);
  void addInertial(const InertialSample& sample);

  /// Motion from the previous frame; without a previous frame only the specific force.
  [[nodiscard]] MotionPrior between(std::optional<Time> previous, Time current) const;

  /// Removes samples that later frames do not need.
  void discardBefore(Time time);

 private:
  [[nodiscard]] std::optional<Eigen::Matrix3d> rotationBetween(Time previous, Time current) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> velocityIncrement(Time previous, Time current) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> specificForceAt(Time time) const;

  std::deque<Stamped<Pose>> odometry_;
  std::deque<Stamped<Eigen::Vector3d>> angular_velocity_;
  std::deque<Stamped<Eigen::Vector3d>> acceleration_;
};

}  // namespace headway::io
