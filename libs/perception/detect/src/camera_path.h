// SPDX-License-Identifier: BSD-3-Clause
// Poses of the camera in the last frames, refined by static points.
#pragma once

#include <headway/core/pose.h>
#include <headway/core/stereo_camera.h>

#include <Eigen/Core>
#include <cmath>
#include <deque>
#include <vector>

namespace headway::detect {

/// A time in tenths of a second, to the millisecond: the jitter of frame times has no effect.
[[nodiscard]] inline double tenthsOf(double seconds) {
  return std::round(1000.0 * seconds) / 100.0;
}

/// A static point and its observation in the newest frame.
struct StaticObservation {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< world of the path [m]
  Eigen::Vector3d uvd = Eigen::Vector3d::Zero();    ///< [px]
};

/// Poses of the camera in the last frames, in a frame of reference of its own ("world").
///
/// Uses the motion between consecutive poses in the odometry frame, which never jump.
class CameraPath {
 public:
  /// @param sigma_px  of an observation's coordinates and disparity [px]
  CameraPath(const StereoCamera& camera, double sigma_px) : camera_(camera), sigma_px_(sigma_px) {}

  /// Adds a frame. @return its number, ascending from 0
  int advance(Time time, const Pose& T_odom_cam);

  /// Refines the newest pose by static points: small errors of the given pose, its prior (4 mm, 0.2
  /// degrees in 0.1 s), would make distant points seem to move.
  ///
  /// A joint Cauchy loss rejects moving points while they are the minority.
  /// @return  ratio of the points that agree with the refined pose; 1 without points
  double refine(const std::vector<StaticObservation>& points);

  /// Removes frames older than `first_kept`.
  void removeBefore(int first_kept);

  [[nodiscard]] int newest() const { return first_ + static_cast<int>(frames_.size()) - 1; }
  [[nodiscard]] int oldest() const { return first_; }
  [[nodiscard]] bool empty() const { return frames_.empty(); }
  [[nodiscard]] Time timeOf(int frame) const { return frames_[frame - first_].time; }
  [[nodiscard]] const Pose& T_cam_world(int frame) const {
    return frames_[frame - first_].T_cam_world;
  }
  /// Time from the frame before to the newest one; 0 if that is the only one [s].
  [[nodiscard]] double lastStep_s() const {
    return frames_.size() < 2 ? 0.0 : frames_.back().time - frames_[frames_.size() - 2].time;
  }
  /// The first frame kept that is not older than `time`; the newest one if all are.
  [[nodiscard]] int firstSince(Time time) const;

 private:
  struct Frame {
    Time time;
    Pose T_cam_world;
  };
  StereoCamera camera_;
  double sigma_px_;
  std::deque<Frame> frames_;
  int first_ = 0;
  Pose T_odom_cam_ = Pose::Identity();  ///< of the newest frame, as given
};

}  // namespace headway::detect
