// SPDX-License-Identifier: BSD-3-Clause
// Rectification and localisation of frames, by SLAM or by recorded poses.
#include "localisation.h"

#include <headway/core/error.h>
#include <headway/pipeline/moving_regions.h>

#include <algorithm>
#include <utility>

namespace headway::pipeline {

Localisation::Localisation(std::shared_ptr<const StereoCamera> camera,
                           const PerceptionParams& params)
    : camera_(std::move(camera)),
      front_end_(params.detection.detect.disparity),
      recorded_poses_(params.slam.trajectory_in_memory) {
  if (camera_ != nullptr) slam_ = std::make_unique<slam::StereoSlam>(camera_, params.slam);
}

slam::StereoSlam* Localisation::slam() const {
  return recorded_poses_.empty() ? slam_.get() : nullptr;
}

bool Localisation::isBySlam(const RecordedFrame& frame) const {
  return !frame.T_map_robot && frame.stereo && slam() != nullptr;
}

std::optional<stereo::FrameContext> Localisation::contextOf(const FrameState& state,
                                                            const RightCamera& right_camera) {
  if (!state.frame.stereo) return std::nullopt;
  const Eigen::Vector3d& turn = right_camera.turn;
  if (rightTurn() != turn) {
    if (state.is_by_slam) slam_->turnRightCamera(turn, !right_camera.has_moved);
    offset_at_recorded_poses_.subtract((turn - rightTurn()).y() /
                                       stereo::yawOfOffset(1.0, *camera_));
    front_end_.setRightTurn({turn, *camera_});
  }
  StereoFrame frame = *state.frame.stereo;
  frame.camera = camera_;
  frame.motion_prior = state.motion_prior;
  return front_end_.next(
      frame, state.is_by_slam ? slam_->disparityOffset() : offset_at_recorded_poses_.value());
}

slam::SlamUpdate Localisation::localise(const FrameState& state) {
  if (!state.is_by_slam) return atRecordedPose(state.frame);
  const PreviousFrame& previous = state.previous;
  const auto moving = movingRegions(state.boxes.sources, previous.tracks, previous.motion,
                                    state.frame.time, *camera_);
  return slam_->process(*state.context, moving, state.images);
}

slam::SlamUpdate Localisation::atRecordedPose(const RecordedFrame& frame) {
  slam::SlamUpdate update;
  if (frame.T_map_robot) {
    update.status = slam::TrackingStatus::kTracked;
    update.T_map_robot = *frame.T_map_robot;
    update.covariance.setZero();
    update.map_odom_covariance.setZero();
  } else if (!recorded_poses_.empty()) {
    update.T_map_robot = poseFrom(recorded_poses_.back().T_map_robot);
  }
  update.T_odom_robot = update.T_map_robot;
  recorded_poses_.append({frame.index, frame.time, headway::stored(update.T_map_robot),
                          frame.T_map_robot.has_value()});
  return update;
}

std::optional<stereo::OffsetEstimate> Localisation::disparityOffset(const FrameState& state) {
  if (state.is_by_slam) return slam_->takeFreeOffset();
  const auto& static_points = state.found.motion.static_points;
  if (static_points.empty()) return std::nullopt;
  // Frames in which no detector ran have none.
  const double seconds = offset_updated_ ? std::max(0.0, state.frame.time - *offset_updated_)
                                         : state.rate.lastInterval();
  offset_updated_ = state.frame.time;
  offset_at_recorded_poses_.update(static_points, seconds);
  return offset_at_recorded_poses_.estimate();
}

void Localisation::remount(std::shared_ptr<const StereoCamera> camera) {
  camera_ = std::move(camera);
  slam_->remount(camera_);
}

void Localisation::load(const map::StoredMap& stored) {
  if (slam_ == nullptr) {
    throw InputError("a map can only be loaded for a stereo camera, and there are poses alone");
  }
  const auto read = stored.attachments.find(map::kSlamAttachment);
  const auto made = stored.made_attachments.find(map::kSlamAttachment);
  if (read != stored.attachments.end()) {
    slam_->load(read->second);
  } else if (made != stored.made_attachments.end()) {
    slam_->load(collected(made->second));
  } else {
    throw InputError("it holds no landmarks that a camera could be localised by");
  }
  front_end_.setRightTurn({slam_->rightTurn(), *camera_});
  is_resumed_ = true;
}

slam::TrajectoryVisit Localisation::trajectorySnapshot() const {
  if (slam() != nullptr) return slam_->trajectorySnapshot();
  return [poses = recorded_poses_.snapshot()](const slam::FrameVisitor& visit) {
    poses->visit([&](const RecordedPose& pose) {
      visit({pose.frame, pose.time, pose.is_recorded, poseFrom(pose.T_map_robot)});
    });
  };
}

void Localisation::mergeTimes(StageTimes& times) const {
  if (slam_ != nullptr) times.merge(slam_->times());
}

}  // namespace headway::pipeline
