// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/moving_regions.h>
#include <headway/core/params.h>
#include <headway/core/recorded_frame.h>
#include <headway/core/track.h>
#include <headway/core/worker_thread.h>
#include <headway/detect/detector_factory.h>
#include <headway/detect/ground_scanner.h>
#include <headway/stereo/frame_context.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace headway::pipeline {

/// Sources of detections. Sections [detect], [disparity], [stereo_motion], [dnn] and [hog].
struct DetectionParams {
  /// "none", "auto", or names joined by "+": "recorded" and those of detect::detectorNames().
  /// "auto" is stereo_motion, with dnn if detect::findModel() finds a model, until the first
  /// recorded boxes, and while they are missing; otherwise the recorded boxes only.
  std::string detector = "auto";
  /// Time without recorded boxes after which they count as missing; with "auto", stereo_motion runs
  /// until they return [s].
  double recorded_timeout_s = 2.0;
  detect::DetectParams detect;

  void describe(Params& params);
  void validate() const;  ///< @throws InputError
};

/// Throws InputError with the available names unless `names` is valid for
/// DetectionParams::detector.
void checkDetectorNames(const std::string& names);

/// Whether `names` include recorded boxes.
[[nodiscard]] bool usesRecordedBoxes(const std::string& names);

/// File of the network that a run with images uses; empty: none.
[[nodiscard]] std::string modelInUse(const DetectionParams& params);

/// Whether a network would be used if a model were found: the detector is "auto".
[[nodiscard]] bool wouldUseModel(const DetectionParams& params);

/// Detections that do not depend on the camera's pose: recorded boxes and image detectors'.
struct ObjectDetections {
  std::optional<stereo::FrameContext> context;  ///< of the frame; nullopt without images
  std::vector<Detections> sources;              ///< by descending quality of their information
  bool detectors_run = false;                   ///< on this frame, one in `every_nth_frame`
  bool classified = false;                      ///< by a network, in this frame
  bool recorded_missing = false;                ///< for longer than `recorded_timeout_s`
  bool lifting = false;                         ///< a box without depth has to be lifted
  double elapsed_ms = 0.0;                      ///< time of these steps [ms]
};

/// All detections of one frame.
struct FrameDetections {
  std::optional<stereo::FrameContext> context;  ///< of the frame; nullopt without images
  std::optional<Detections>
      fused;  ///< of all sources, without duplicates, with depth; nullopt: none
  detect::MotionDetections motion;  ///< of this frame, or of the last evaluated one
  DropCounts dropped;               ///< by reason
  bool images_used = false;         ///< by a detector or for lifting
  double elapsed_ms = 0.0;          ///< time of all steps so far [ms]
};

/// Detects objects in a frame from every source, in three steps around SLAM and the tracker. The
/// result of each step is passed to the next one as a value.
///
///     const auto boxes = stage.detectObjects(frame, context);
///     const auto regions = movingRegions(boxes.sources, tracked.tracks, found.motion, time,
///     camera); const auto pose = slam.process(*context, regions); found =
///     stage.detectMotion(frame, pose, boxes, tracked.expected, found.motion); tracked =
///     tracker.update(index, pose, *found.fused); const auto scan = stage.scanGround(frame, pose,
///     found, tracked.tracks, params);
class DetectionStage {
 public:
  /// @param camera  null without images: then only recorded boxes are available
  /// @throws InputError for detectors that are unknown, need images that do not exist, or have no
  ///                    suitable model
  DetectionStage(std::shared_ptr<const StereoCamera> camera, const DetectionParams& params);
  ~DetectionStage();

  /// Collects a frame's recorded boxes and runs the detectors that need no pose. Stereo matching
  /// starts in its own thread if a later step needs it.
  ///
  /// @param context         of the frame; nullopt without images
  /// @param ground_scanned  scanGround() will be called for this frame
  [[nodiscard]] ObjectDetections detectObjects(const RecordedFrame& frame,
                                               const std::optional<stereo::FrameContext>& context,
                                               bool ground_scanned = false);

  /// Detects moving objects, fuses all sources, and lifts boxes that have no depth.
  ///
  /// @param T_map_robot  nullopt if the camera is lost
  /// @param boxes        of this frame
  /// @param expected     objects, by the tracker after the previous frame
  /// @param previous     result for a frame that is not evaluated for motion
  [[nodiscard]] FrameDetections detectMotion(const RecordedFrame& frame,
                                             const std::optional<Pose>& T_map_robot,
                                             const ObjectDetections& boxes,
                                             const std::vector<ExpectedObject>& expected,
                                             const detect::MotionDetections& previous);

  /// Changes DetectParams::every_nth_frame and DetectionParams::recorded_timeout_s.
  void change(int every_nth_frame, double recorded_timeout_s) {
    every_nth_frame_ = every_nth_frame;
    recorded_timeout_s_ = recorded_timeout_s;
  }

  /// Discards what refers to earlier frames: the clock was set back.
  void restart();

  /// Regions of moving and possibly moving objects, which the static map leaves out.
  ///
  /// @param found   in this frame
  /// @param tracks  of this frame
  [[nodiscard]] MovingRegions leftOutOfMap(const RecordedFrame& frame, const Pose& T_map_robot,
                                           const FrameDetections& found,
                                           const std::vector<Track>& tracks) const;

  /// The same and all that may move later, which the dense map leaves out: people who stand still
  /// are obstacles of the grid, but no part of the world that is shown.
  [[nodiscard]] MovingRegions leftOutOfDenseMap(const RecordedFrame& frame, const Pose& T_map_robot,
                                                const FrameDetections& found,
                                                const std::vector<Track>& tracks) const;

  /// Scans free ground and obstacles, without moving objects.
  ///
  /// @param found   in this frame
  /// @param tracks  of this frame
  /// @return        nullopt if no ground is found (expected, not an error)
  [[nodiscard]] std::optional<GroundScan> scanGround(const RecordedFrame& frame,
                                                     const Pose& T_map_robot,
                                                     const FrameDetections& found,
                                                     const std::vector<Track>& tracks,
                                                     const detect::GroundScanParams& params);

 private:
  void addRecorded(const RecordedFrame& frame, ObjectDetections& boxes);

  std::shared_ptr<const StereoCamera> camera_;
  detect::StereoMotionParams stereo_motion_params_;
  double recorded_timeout_s_ = 0.0;
  std::optional<Time> last_recorded_;  ///< of the newest recorded boxes
  bool use_recorded_ = false;
  bool automatic_ = false;  ///< image detectors run only without recorded boxes
  bool has_network_ = false;
  int every_nth_frame_ = 1;
  std::vector<std::unique_ptr<detect::Detector>> detectors_;
  std::optional<detect::StereoMotion> stereo_motion_;
  int frames_ = 0;
  WorkerThread matcher_;  ///< for stereo matching while SLAM runs
};

}  // namespace headway::pipeline
