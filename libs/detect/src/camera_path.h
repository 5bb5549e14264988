#pragma once

#include <headway/core/pose.h>
#include <headway/core/stereo_camera.h>

#include <Eigen/Core>
#include <deque>
#include <vector>

namespace headway::detect {

/// A still point of the world and where the newest frame sees it.
struct StillSighting {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< world of the path [m]
  Eigen::Vector3d uvd = Eigen::Vector3d::Zero();    ///< [px]
};

/// Where the camera was in the last few frames, in a world of the path's own.
///
/// Only motion from frame to frame is taken from the poses given, and where no vehicle accelerates
/// like that, the map has jumped (a loop closed) and the camera is taken to go on as before.
class CameraPath {
 public:
  /// @param sigma_px  of a sighting's coordinates and disparity [px]
  CameraPath(const StereoCamera& camera, double sigma_px) : camera_(camera), sigma_px_(sigma_px) {}

  /// Adds a frame. @return its number, ascending from 0
  int advance(Time time, const Pose& T_map_cam);

  /// Corrects the newest camera by what it sees of the still world: the slight errors of the pose
  /// given (its prior: 4 mm, 0.2 degrees; ten times that after a jump) would make everything far
  /// away seem to move.
  ///
  /// Robust (Cauchy), so that what moves among the points has no say while it is not the most.
  /// @return  share of the points that agree with the corrected camera; 1 where there are none
  double refine(const std::vector<StillSighting>& points);

  /// Forgets frames older than `first_kept`.
  void forgetBefore(int first_kept);

  [[nodiscard]] int newest() const { return first_ + static_cast<int>(frames_.size()) - 1; }
  [[nodiscard]] int oldest() const { return first_; }
  [[nodiscard]] bool empty() const { return frames_.empty(); }
  [[nodiscard]] Time timeOf(int frame) const { return frames_[frame - first_].time; }
  [[nodiscard]] const Pose& T_cam_world(int frame) const {
    return frames_[frame - first_].T_cam_world;
  }
  /// The first frame kept that is not older than `time`; the newest one if all are.
  [[nodiscard]] int firstSince(Time time) const;
  /// Camera in `ahead` seconds as seen from the newest one, if it goes on as between the last two
  /// frames; takes points from the newest camera to the later one.
  [[nodiscard]] Pose expectedMotion(double ahead) const;
  /// Turn from this world to the map, as the newest pose given says.
  [[nodiscard]] Eigen::Matrix3d R_map_world() const;

 private:
  struct Frame {
    Time time;
    Pose T_cam_world;
  };
  StereoCamera camera_;
  double sigma_px_;
  std::deque<Frame> frames_;
  int first_ = 0;
  Pose T_map_cam_ = Pose::Identity();  ///< of the newest frame, as given
  bool guessed_ = false;               ///< the newest frame's motion was not given
};

}  // namespace headway::detect
