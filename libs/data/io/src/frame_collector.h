// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_frame.h>
#include <headway/io/rawlog_source.h>
#include <mrpt/obs/CObservation2DRangeScan.h>

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "camera_choice.h"
#include "clock_check.h"
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
  ///                 name, those of fixFrom(), "gnss_between_frames", and the counts of
  ///                 StereoPairing and FrameAssembler
  FrameCollector(const CameraChoice& camera, const RawlogSourceOptions& options,
                 std::map<std::string, std::size_t>& skipped)
      : has_camera_(camera.kind != CameraChoice::Kind::kNone),
        left_label_(camera.labels[0]),
        skipped_(skipped),
        pairing_(camera, options.pair_tolerance_s, skipped),
        assembler_(options.read_ahead, skipped) {}

  /// @param arrival_s  time of arrival by a live source's clock, for the frame it completes [s]
  void add(const mrpt::obs::CObservation::Ptr& observation, double arrival_s = 0.0);
  /// Counts unassigned observations at the end.
  void finish();

  /// Least time between images of two cameras that are no pair [s], see StereoPairing.
  [[nodiscard]] double nearestUnpaired() const { return pairing_.nearest(); }

  /// Whether take() can return a frame before the end of the recording.
  [[nodiscard]] bool isReady() const { return assembler_.isReady(); }
  /// Number of frames that take() can return before the end of the recording.
  [[nodiscard]] std::size_t ready() const { return assembler_.ready(); }
  /// Number of frames; of boxes, poses and scans; of motion samples that are stored.
  [[nodiscard]] std::size_t frames() const { return assembler_.frames(); }
  [[nodiscard]] std::size_t items() const { return assembler_.items(); }
  [[nodiscard]] std::size_t samples() const { return prior_.samples(); }
  /// Removes the oldest samples of each motion sensor, and boxes, poses and scans of each laser,
  /// above these numbers.
  void limit(std::size_t max_samples, std::size_t max_items) {
    prior_.limitSamples(max_samples);
    assembler_.limitItems(max_items);
    limitFixes(max_items);
  }
  /// The next frame; nullopt if there is none. Before isReady(), only at the recording's end.
  [[nodiscard]] std::optional<PendingFrame> take() { return assembler_.take(); }

  /// Removes and returns the fixes of satellite receivers up to a time, in order of arrival.
  [[nodiscard]] std::vector<GnssFix> takeFixes(Time until);
  /// Motion between two times according to odometry and inertial samples.
  [[nodiscard]] MotionPrior motionBetween(std::optional<Time> previous, Time current) const {
    return prior_.between(previous, current);
  }
  /// Prolongs the motion sensors' last samples to a time, see MotionPriorBuilder.
  void extrapolateMotion(Time to, double max_s) { prior_.extrapolate(to, max_s); }
  /// Sensors with clocks of their own, see ClockCheck.
  [[nodiscard]] const Warnings& warnings() const { return warnings_; }
  /// Removes samples that are not needed for motions starting at or after this time.
  void discardMotionBefore(Time time) { prior_.discardBefore(time); }

 private:
  void compareClocks(const mrpt::obs::CObservation& observation);
  void addPair(RecordedPair pair, double arrival_s);
  [[nodiscard]] bool isReachable(Time time, const Pose& T_map_robot);
  void addPose(Time time, const Pose& T_map_robot, double arrival_s);
  void addMotion(const mrpt::obs::CObservation& observation);
  void limitFixes(std::size_t max_count);
  void addLaser(const mrpt::obs::CObservation2DRangeScan& observation);

  bool has_camera_;
  std::string left_label_;
  std::map<std::string, std::size_t>& skipped_;
  StereoPairing pairing_;
  FrameAssembler assembler_;
  MotionPriorBuilder prior_;
  std::deque<GnssFix> fixes_;  ///< not yet taken
  ClockCheck clocks_;
  Warnings warnings_;
  std::optional<Stamped<Pose>> last_pose_;     ///< recorded and used
  std::optional<Stamped<Pose>> distant_pose_;  ///< the last one, if it was too far from the former
};

}  // namespace headway::io
