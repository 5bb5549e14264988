// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_frame.h>
#include <headway/slam/stereo_slam.h>

#include <functional>
#include <optional>

#include "gravity_estimator.h"

namespace headway::slam {

/// Compares the gyroscope's turns with the camera's.
class GyroscopeCheck {
 public:
  void add(const Eigen::Matrix3d& by_gyroscope, const Eigen::Matrix3d& by_camera, double seconds);
  [[nodiscard]] bool isContradictory() const;

 private:
  double turned_rad_ = 0.0;
  double differed_rad_ = 0.0;
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
