// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stage_times.h>
#include <headway/slam/stereo_slam.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "active_submap.h"
#include "anchored_trajectory.h"
#include "bundle_adjuster.h"
#include "frame_tracker.h"
#include "inertial_alignment.h"
#include "keyframe_odometry.h"
#include "local_mapper.h"
#include "loop_closer.h"
#include "make_map_view.h"
#include "map_archive.h"
#include "motion_model.h"
#include "odometry_check.h"
#include "tracking_frame.h"

namespace headway::slam {

/// Processes a frame step by step and keeps the state between frames.
class StereoSlam::Implementation {
 public:
  Implementation(std::shared_ptr<const StereoCamera> camera, const SlamParams& params)
      : camera_(std::move(camera)),
        T_cam_robot_(camera_->T_robot_cam.inverse(Eigen::Isometry)),
        params_(params),
        tracker_(*camera_, params),
        adjuster_(*camera_, params.adjust_in_background, params.stop),
        mapper_(*camera_, params, adjuster_),
        loops_(*camera_, params, adjuster_),
        motion_(camera_->T_robot_cam, params),
        odometry_since_tracked_(params.use_odometry),
        views_(T_cam_robot_),
        trajectory_(params.trajectory_in_memory) {}

  SlamUpdate process(const stereo::FrameContext& context, const MovingRegions& moving,
                     ImageEvidence images);
  void finish() {
    applyCorrectionToMotion(loops_.finish(map_).correction);
    applyCorrectionToMotion(adjuster_.finish(map_));
  }
  void load(const std::string& bytes);
  void correct(const KeyframePoses& poses);
  [[nodiscard]] const SparseMap& sparseMap() const { return map_; }
  [[nodiscard]] const StereoCamera& camera() const { return *camera_; }
  [[nodiscard]] const SlamParams& params() const { return params_; }
  [[nodiscard]] std::string save() const { return packMap(map_, *camera_); }
  [[nodiscard]] ByteSource snapshot() const { return mapBytes(map_, *camera_); }
  [[nodiscard]] double disparityOffset() const { return map_.disparityOffset(); }
  [[nodiscard]] std::optional<stereo::OffsetEstimate> takeFreeOffset() {
    return adjuster_.takeFreeOffset();
  }
  void turnRightCamera(const Eigen::Vector3d& angles, bool always_so);
  [[nodiscard]] MapView map() { return views_.make(map_); }
  [[nodiscard]] TrajectoryVisit trajectorySnapshot() const {
    return trajectory_.snapshot(map_, T_cam_robot_);
  }
  [[nodiscard]] const StageTimes& times() const { return times_; }

 private:
  std::optional<TrackedPose> track(const stereo::FrameContext& context,
                                   const TrackingFrame& current);
  void initialiseMotion(const stereo::FrameContext& context);
  void levelMap(const StereoFrame& frame, const Stamped<Pose>& previous, const Pose& T_map_cam,
                double sigma_m);
  SlamUpdate localised(const StereoFrame& frame, const TrackingFrame& current,
                       std::optional<TrackedPose>& tracked, ImageEvidence images);
  Doubt doubtOf(const MeasuredStep& step, double seconds, const MotionPrior& prior);
  SlamUpdate accept(const TrackingFrame& current, TrackedPose& tracked);
  SlamUpdate handleLost(const StereoFrame& frame, const TrackingFrame& current);
  void coast(const StereoFrame& frame);
  [[nodiscard]] PoseCovariance predictedCovariance(const PoseCovariance& before,
                                                   const OdometryLink& link) const;
  SlamUpdate passOver(const StereoFrame& frame);
  bool initialise(const TrackingFrame& current);
  void makeKeyframe(const TrackingFrame& current, TrackedPose& tracked, SlamUpdate& update);
  void setReferenceKeyframe(KeyframeId keyframe);
  void removeSubmap(KeyframeId first, KeyframeId end);
  void remove(KeyframeId keyframe, KeyframeId replacement);
  LoopProgress takeBackgroundWork();
  void applyCorrectionToMotion(const std::optional<Pose>& correction);

  std::shared_ptr<const StereoCamera> camera_;
  Pose T_cam_robot_;
  SlamParams params_;
  FrameTracker tracker_;
  BundleAdjuster adjuster_;
  LocalMapper mapper_;
  LoopCloser loops_;
  MotionModel motion_;
  InertialAlignment inertial_;
  OdometryCheck odometry_check_;
  StandstillCheck standstill_check_;
  KeyframeOdometry odometry_since_tracked_;  ///< from the last tracked frame
  SparseMap map_;
  MapViewMaker views_;
  AnchoredTrajectory trajectory_;
  StageTimes times_;

  TrackingFrame previous_;                              ///< the last one that was tracked
  std::vector<TrackedLandmark> seen_before_;            ///< landmarks of that frame
  std::optional<KeyframeId> reference_;                 ///< keyframe that it belongs to
  std::vector<LandmarkId> local_landmarks_;             ///< those around that keyframe
  PoseCovariance covariance_ = PoseCovariance::Zero();  ///< of the last camera pose
  PoseCovariance covariance_when_tracked_ = PoseCovariance::Zero();  ///< in the last such frame
  double previous_sigma_m_ = 0.0;  ///< of its position in the local map
  ActiveSubmap active_submap_;
  int lost_in_a_row_ = 0;
  bool relocalised_ = false;  ///< the newest pose, in the whole map: no motion from the one before
};

}  // namespace headway::slam
