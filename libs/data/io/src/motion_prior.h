// SPDX-License-Identifier: BSD-3-Clause
// Motion between frames by wheel odometry and inertial samples.
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

inline constexpr double kMaxTimeGap_s = 10.0;  ///< to a time that the next one need not confirm

/// What of odometry and inertial samples is used.
struct MotionPriorParams {
  double force_before_s = 0.25;  ///< window of the mean specific force, before a frame [s]
  double force_after_s = 0.05;   ///< and after it [s]
  std::size_t min_force_samples = 3;
  double max_odometry_gap_s = 1.0;  ///< between samples that are interpolated [s]
  double max_inertial_gap_s = 0.1;  ///< the same [s]
  double max_odometry_ratio = 5.0;  ///< of an extrapolation to the samples' interval [-]
};

/// Computes motion priors between frames from wheel odometry and inertial samples.
///
/// Odometry is interpolated at the frames' times; gyroscope and accelerometer are integrated
/// between them. Quantities that are not covered by samples remain empty.
class MotionPriorBuilder {
 public:
  explicit MotionPriorBuilder(const MotionPriorParams& params = {}) : params_(params) {}

  /// @param T_odom_robot  robot in the odometry's frame, in time order
  void addOdometry(Time time, const Pose& T_odom_robot);
  void addInertial(const InertialSample& sample);

  /// Motion from the previous frame; without a previous frame only the specific force.
  [[nodiscard]] MotionPrior between(std::optional<Time> previous, Time current) const;

  /// Adds a sample at `time` to each sensor whose last sample is older by at most `max_s`: the last
  /// inertial values; the odometry's pose at the speed of its last two samples. For live frames,
  /// which are processed before the sensors' next samples arrive.
  void extrapolate(Time time, double max_s);

  /// Removes samples that later frames do not need.
  void discardBefore(Time time);
  /// Removes the oldest samples of each sensor above this number.
  void limitSamples(std::size_t max_count);
  /// Number of stored samples of all sensors.
  [[nodiscard]] std::size_t samples() const {
    return odometry_.size() + angular_velocity_.size() + acceleration_.size();
  }

 private:
  template <typename T>
  void addInOrder(std::deque<Stamped<T>>& samples, Time time, const T& value) const;
  [[nodiscard]] std::optional<Eigen::Matrix3d> rotationBetween(Time previous, Time current) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> velocityIncrement(Time previous, Time current) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> specificForceAt(Time time) const;

  MotionPriorParams params_;
  std::deque<Stamped<Pose>> odometry_;
  std::deque<Stamped<Eigen::Vector3d>> angular_velocity_;
  std::deque<Stamped<Eigen::Vector3d>> acceleration_;
};

}  // namespace headway::io
