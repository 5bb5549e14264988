// SPDX-License-Identifier: BSD-3-Clause
// The parts of StereoSlam for frames whose images do not tell the pose.
#include "pose_covariance.h"
#include "stereo_slam_implementation.h"

namespace headway::slam {

/// The pose of a frame whose images say nothing is the predicted one. Its covariance grows by that
/// of wheel odometry since the last tracked frame, or without it by a constant.
void StereoSlam::Implementation::coast(const StereoFrame& frame) {
  constexpr double kGrowth = 0.01;  ///< variance that each such frame adds [m^2], [rad^2]
  ++lost_in_a_row_;
  if (!reference_) return;
  motion_.coast(frame.time, motion_.predict(frame));
  if (const auto& link = odometry_since_tracked_.link()) {
    covariance_ = predictedCovariance(covariance_when_tracked_, *link);
  } else {
    covariance_ += kGrowth * PoseCovariance::Identity();
  }
}

/// Covariance of the camera's pose after a motion of the robot by wheel odometry.
PoseCovariance StereoSlam::Implementation::predictedCovariance(const PoseCovariance& before,
                                                               const OdometryLink& link) const {
  const auto of_robot = composedCovariance(before, T_cam_robot_, PoseCovariance::Zero());
  const auto moved = composedCovariance(of_robot, link.T_from_this, covarianceOf(link));
  return composedCovariance(moved, camera_->T_robot_cam, PoseCovariance::Zero());
}

/// The images were seen before, while the robot may move on.
SlamUpdate StereoSlam::Implementation::passOver(const StereoFrame& frame) {
  coast(frame);
  odometry_check_.restart();
  inertial_.interrupt();
  SlamUpdate update;
  update.status = TrackingStatus::kUnreliable;
  update.doubt = Doubt::kFrozen;
  return update;
}

/// The camera is lost: predict its pose, and initialise a new submap after a while.
SlamUpdate StereoSlam::Implementation::handleLost(const StereoFrame& frame,
                                                  const TrackingFrame& current) {
  SlamUpdate update;
  coast(frame);
  const bool is_over =
      reference_ && lost_in_a_row_ > active_submap_.maxLostFrames(params_.restart_after_frames);
  if (params_.mapping && (is_over || map_.keyframes().empty()) && initialise(current)) {
    lost_in_a_row_ = 0;
    update.status = TrackingStatus::kTracked;
    update.is_keyframe = true;
    update.inliers = update.features = static_cast<int>(seen_before_.size());
  }
  return update;
}

/// Inserts a first keyframe at the predicted pose; false, and no change, with too few landmarks.
bool StereoSlam::Implementation::initialise(const TrackingFrame& current) {
  std::vector<TrackedLandmark> landmarks;
  const KeyframeId id = mapper_.insert(current, motion_.last(), covariance_, landmarks, map_);
  if (static_cast<int>(landmarks.size()) < params_.min_inliers) {
    map_.removeKeyframe(id);
    return false;
  }
  loops_.index(id, map_);
  setReferenceKeyframe(id);
  if (active_submap_.isNew()) removeSubmap(active_submap_.first(), id);
  active_submap_.initialise(id);
  seen_before_ = std::move(landmarks);
  return true;
}

}  // namespace headway::slam
