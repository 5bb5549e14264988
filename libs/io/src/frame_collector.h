#pragma once

#include <headway/core/stereo_frame.h>
#include <headway/io/rawlog_source.h>
#include <mrpt/obs/CObservation2DRangeScan.h>

#include <map>
#include <optional>
#include <string>

#include "camera_choice.h"
#include "frame_assembler.h"
#include "motion_prior.h"
#include "stereo_pairing.h"

namespace headway::io {

/// Assembles frames from observations: images, boxes, poses, and motion for the prior.
///
/// Without a camera, each pose is a frame.
class FrameCollector {
 public:
  /// @param skipped  counts "bad_odometry", "bad_imu", "bad_pose", "pose_jump",
  /// "bad_detections_pose",
  ///                 "laser_bad_pose", "laser_no_ranges", observations of other cameras by class
  ///                 name, and the counts of StereoPairing and FrameAssembler
  FrameCollector(const CameraChoice& camera, const RawlogSourceOptions& options,
                 std::map<std::string, std::size_t>& skipped)
      : has_camera_(camera.kind != CameraChoice::Kind::kNone),
        skipped_(skipped),
        pairing_(camera, options.pair_tolerance_s, skipped),
        assembler_(options.read_ahead, skipped) {}

  void add(const mrpt::obs::CObservation::Ptr& observation);
  /// Counts unassigned observations at the end.
  void finish();

  /// Whether take() can return a frame before the end of the recording.
  [[nodiscard]] bool isReady() const { return assembler_.isReady(); }
  /// The next frame; nullopt if there is none. Before isReady(), only at the recording's end.
  [[nodiscard]] std::optional<PendingFrame> take() { return assembler_.take(); }

  /// Motion between two times according to odometry and inertial samples.
  [[nodiscard]] MotionPrior motionBetween(std::optional<Time> previous, Time current) const {
    return prior_.between(previous, current);
  }
  /// Removes samples that are not needed for motions starting at or after this time.
  void discardMotionBefore(Time time) { prior_.discardBefore(time); }

 private:
  void addPair(RecordedPair pair);
  [[nodiscard]] bool isReachable(Time time, const Pose& T_map_robot);
  void addPose(Time time, const Pose& T_map_robot);
  void addMotion(const mrpt::obs::CObservation& observation);
  void addLaser(const mrpt::obs::CObservation2DRangeScan& observation);

  bool has_camera_;
  std::map<std::string, std::size_t>& skipped_;
  StereoPairing pairing_;
  FrameAssembler assembler_;
  MotionPriorBuilder prior_;
  std::optional<Stamped<Pose>> last_pose_;     ///< recorded and used
  std::optional<Stamped<Pose>> distant_pose_;  ///< the last one, if it was too far from the former
};

}  // namespace headway::io
