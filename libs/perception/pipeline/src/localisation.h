// SPDX-License-Identifier: BSD-3-Clause
// Rectification and localisation of frames, by SLAM or by recorded poses.
#pragma once

#include <headway/core/record_log.h>
#include <headway/map/map_file.h>
#include <headway/stereo/rectification.h>

#include <memory>

#include "frame_state.h"
#include "input_health.h"

namespace headway::pipeline {

/// Rectifies frames and localises them: by SLAM, or as their poses are recorded. Once a pose was
/// recorded, SLAM is not used any more.
class Localisation {
 public:
  /// @param camera  null without images: then poses have to be recorded
  Localisation(std::shared_ptr<const StereoCamera> camera, const PerceptionParams& params);

  /// Whether the frame's pose is not a recorded one, and it has images.
  [[nodiscard]] bool isBySlam(const RecordedFrame& frame) const;

  /// The frame's images with the right camera's rotation undone; nullopt without images.
  [[nodiscard]] std::optional<stereo::FrameContext> contextOf(const FrameState& state,
                                                              const RightCamera& right_camera);
  /// By which right images are turned back: pitch, yaw, roll [rad].
  [[nodiscard]] const Eigen::Vector3d& rightTurn() const { return front_end_.rightTurn().angles(); }

  /// The pose by SLAM, from what does not move, or the recorded one; lost without both.
  [[nodiscard]] slam::SlamUpdate localise(const FrameState& state);

  /// Measured less true disparity, with what this frame adds; nullopt if that is nothing.
  [[nodiscard]] std::optional<stereo::OffsetEstimate> disparityOffset(const FrameState& state);

  /// The camera is mounted otherwise.
  void remount(std::shared_ptr<const StereoCamera> camera);

  /// Loads SLAM's map, before the first frame. @throws InputError as Perception::resume()
  void load(const map::StoredMap& stored);
  [[nodiscard]] bool isResumed() const { return is_resumed_; }

  [[nodiscard]] slam::TrajectoryVisit trajectorySnapshot() const;
  /// The one that made the map; null if poses were recorded.
  [[nodiscard]] slam::StereoSlam* slam() const;
  void mergeTimes(StageTimes& times) const;

 private:
  [[nodiscard]] slam::SlamUpdate atRecordedPose(const RecordedFrame& frame);

  std::shared_ptr<const StereoCamera> camera_;
  std::unique_ptr<slam::StereoSlam> slam_;  ///< null without camera
  stereo::FrontEnd front_end_;
  stereo::DisparityOffset offset_at_recorded_poses_;  ///< where SLAM does not estimate it
  std::optional<Time> offset_updated_;
  bool is_resumed_ = false;  ///< the map frame is a stored map's
  struct RecordedPose {
    std::size_t frame;
    Time time;
    StoredPose T_map_robot;
    bool is_recorded;  ///< false: the pose is the last one that was
  };
  RecordLog<RecordedPose> recorded_poses_;
};

}  // namespace headway::pipeline
