// SPDX-License-Identifier: BSD-3-Clause
// Wheel odometry between keyframes, its uncertainty, and its comparison with the camera.
#pragma once

#include <headway/core/stereo_frame.h>

#include <deque>
#include <optional>

#include "bundle_solver.h"
#include "sparse_map.h"

namespace headway::slam {

/// Sums up wheel odometry from one keyframe to the next.
class KeyframeOdometry {
 public:
  /// @param use  false: there are no links
  explicit KeyframeOdometry(bool use) : use_(use) {}

  /// Adds the motion since the frame before; without one there is no link until the next restart.
  void add(const MotionPrior& prior);
  /// The motion since the last keyframe; nullopt if it is not known throughout.
  [[nodiscard]] const std::optional<OdometryLink>& link() const { return link_; }
  /// Starts anew at a keyframe, or at a frame that belongs to it.
  void restartAt(KeyframeId keyframe);

 private:
  bool use_ = true;
  std::optional<OdometryLink> link_;
};

/// Errors of wheel odometry on a robot with two driven wheels or a car's axle.
struct WheelNoise {
  double floor_m = 0.01;         ///< backlash and time stamps
  double along = 0.02;           ///< scale and slip, of the path [-]
  double slope_rad = 0.1;        ///< of the ground against the robot's plane: 6 degrees
  double yaw_floor_rad = 0.005;  ///< backlash over the track width
  double yaw_by_turn = 0.05;     ///< error of the track width [-]
  double yaw_rad_per_m = 0.01;   ///< different slip of both wheels
};

/// Standard deviations of a link for a BundleProblem::Motion: (translation [m], rotation [rad]).
///
/// Wheels measure motion in the plane that the robot stands on, so the other components have the
/// uncertainty of the ground's slope.
[[nodiscard]] Eigen::Matrix<double, 6, 1> sigmaOf(const OdometryLink& link);

/// The same as the covariance of a pose that was predicted by the link (right perturbation). A
/// wrong direction displaces half of the path.
[[nodiscard]] PoseCovariance covarianceOf(const OdometryLink& link);

/// A camera's motion between two frames, as part of its comparison with wheel odometry.
struct MeasuredStep {
  Time time = 0.0;              ///< of its end [s]
  Pose T_previous_current;      ///< of the robot
  double position_sigma = 0.0;  ///< of the pose at its end, in the local map [m]
  double rotation_sigma = 0.0;  ///< [rad]
};

/// Compares the camera's motion with wheel odometry over the last second.
class OdometryCheck {
 public:
  /// Adds the motion between two frames that were both tracked.
  ///
  /// @return false if the motions differ by more than three standard deviations
  bool add(const MeasuredStep& by_camera, const MotionPrior& prior);
  /// The camera was lost, or odometry is missing: earlier motions do not count.
  void restart() { window_.clear(); }

 private:
  /// Both motions from the start of the window to one moment.
  struct Moment {
    Time time = 0.0;
    Pose T_start_now = Pose::Identity();  ///< by the camera
    OdometryLink by_wheels;
    double position_sigma = 0.0;
    double rotation_sigma = 0.0;
  };

  std::deque<Moment> window_;
};

/// Tells by wheel odometry whether images that show nothing new may still be right.
class StandstillCheck {
 public:
  /// Adds the motion since the frame before.
  ///
  /// @param is_new  whether the frame's images show something new
  /// @return        true if the wheels are slower than their noise over a second, and not farther
  ///                than that noise from where the newest such images were taken
  bool add(Time time, const MotionPrior& prior, bool is_new);

 private:
  std::optional<Time> last_;       ///< of the frame before
  std::optional<Pose> T_new_now_;  ///< since the images that were new; nullopt: not known
};

}  // namespace headway::slam
