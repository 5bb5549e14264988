#pragma once

#include <headway/core/stereo_frame.h>
#include <headway/io/rawlog_source.h>

#include <map>
#include <optional>
#include <string>

#include "camera_choice.h"
#include "frame_assembler.h"
#include "motion_prior.h"
#include "stereo_pairing.h"

namespace headway::io {

/// Sorts observations: images become frames, boxes and poses go to theirs, motions to the prior.
///
/// Where there is no camera, each pose is a frame of its own.
class FrameCollector {
 public:
  /// @param skipped  counts "bad_odometry", "bad_pose", by class name what is of no camera chosen,
  ///                 and what StereoPairing and FrameAssembler count
  FrameCollector(const CameraChoice& camera, const RawlogSourceOptions& options,
                 std::map<std::string, std::size_t>& skipped)
      : has_camera_(camera.kind != CameraChoice::Kind::kNone),
        skipped_(skipped),
        pairing_(camera, options.pair_tolerance_s, skipped),
        assembler_(options.read_ahead, skipped) {}

  void add(const mrpt::obs::CObservation::Ptr& observation);
  /// Counts what waits for more: nothing will come.
  void finish();

  /// Whether a frame can be taken without knowing more of the recording.
  [[nodiscard]] bool isReady() const { return assembler_.isReady(); }
  /// The next frame; nullopt if there is none. Before isReady(), only at the recording's end.
  [[nodiscard]] std::optional<PendingFrame> take() { return assembler_.take(); }

  /// What odometry and inertial samples say of the motion, as far as they were added.
  [[nodiscard]] MotionPrior motionBetween(std::optional<Time> previous, Time current) const {
    return prior_.between(previous, current);
  }
  /// No motion that begins before this time will be asked for.
  void forgetMotionBefore(Time time) { prior_.forgetBefore(time); }

 private:
  void addPair(RecordedPair pair);
  void addPose(Time time, const Pose& T_map_robot);
  void addMotion(const mrpt::obs::CObservation& observation);

  bool has_camera_;
  std::map<std::string, std::size_t>& skipped_;
  StereoPairing pairing_;
  FrameAssembler assembler_;
  MotionPriorBuilder prior_;
};

}  // namespace headway::io
