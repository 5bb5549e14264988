// SPDX-License-Identifier: BSD-3-Clause
// Detections of a frame from all sources, before and after the pose is known.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/recorded_frame.h>
#include <headway/core/worker_thread.h>
#include <headway/detect/detector.h>
#include <headway/detect/people_by_shape.h>
#include <headway/detect/stereo_motion.h>
#include <headway/pipeline/perception_params.h>
#include <headway/stereo/frame_context.h>

#include <memory>
#include <optional>
#include <vector>

namespace headway::pipeline {

/// Detections that do not depend on the camera's pose: recorded boxes and image detectors'.
struct ObjectDetections {
  std::optional<stereo::FrameContext> context;  ///< of the frame; nullopt without images
  std::vector<Detections> sources;              ///< by descending quality of their information
  bool detectors_run = false;                   ///< any image detector, on this frame
  bool all_detectors_ran = true;                ///< those too that run once in `period_s`
  bool classified = false;                      ///< by a network, in this frame
  bool recorded_missing = false;                ///< for longer than `recorded_timeout_s`
  bool lifting = false;                         ///< a box without depth has to be lifted
  double elapsed_ms = 0.0;                      ///< time of these steps [ms]
};

/// All detections of one frame.
struct FrameDetections {
  std::optional<Detections>
      fused;  ///< of all sources, without duplicates, with depth; nullopt: none
  detect::MotionDetections motion;  ///< of this frame, or of the last evaluated one
  DropCounts dropped;               ///< by reason
  bool images_used = false;         ///< by a detector or for lifting
  double elapsed_ms = 0.0;          ///< time of all steps so far [ms]
};

/// Detects objects in a frame from every source, in two steps around SLAM. The result of each is
/// passed to the next one as a value.
///
///     const auto boxes = stage.detectObjects(frame, context);
///     const auto regions = movingRegions(boxes.sources, tracks, motion, frame.time, camera);
///     const auto pose = slam.process(*context, regions);
///     const auto found = stage.detectMotion(frame, pose, boxes, expected, motion);
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
  /// @param is_new          its images are not those of the frame before
  /// @param ground_scanned  the ground of this frame will be scanned
  [[nodiscard]] ObjectDetections detectObjects(const RecordedFrame& frame,
                                               const std::optional<stereo::FrameContext>& context,
                                               bool is_new = true, bool ground_scanned = false);

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

  /// Changes DetectParams::period_s and DetectionParams::recorded_timeout_s.
  void change(double period_s, double recorded_timeout_s) {
    period_s_ = period_s;
    recorded_timeout_s_ = recorded_timeout_s;
  }

  /// Discards what refers to earlier frames: the clock was set back.
  void restart();
  /// The camera is mounted otherwise: discards what moved before.
  void remount(std::shared_ptr<const StereoCamera> camera);
  /// Whether people are looked for by their shape: if asked for, or on a robot.
  [[nodiscard]] bool looksForShapes() const { return shape_.has_value(); }

 private:
  /// Whether `detectors_` are due in a frame: the one nearest to the end of the period.
  [[nodiscard]] bool isDue(Time time);
  void addRecorded(const RecordedFrame& frame, ObjectDetections& boxes);
  void mountShape();

  std::shared_ptr<const StereoCamera> camera_;
  detect::StereoMotionParams stereo_motion_params_;
  std::optional<detect::ShapeParams> shape_params_;  ///< nullopt: not a detector here
  double recorded_timeout_s_ = 0.0;
  std::optional<Time> last_recorded_;  ///< of the newest recorded boxes
  bool use_recorded_ = false;
  bool automatic_ = false;  ///< image detectors run only without recorded boxes
  bool has_network_ = false;
  double period_s_ = 0.0;                                     ///< of `detectors_` [s]
  std::vector<std::unique_ptr<detect::Detector>> detectors_;  ///< slow ones
  std::optional<Time> last_run_;                              ///< of them
  std::optional<Time> last_images_;
  std::optional<detect::StereoMotion> stereo_motion_;
  std::optional<detect::PeopleByShape> shape_;
  WorkerThread matcher_;  ///< for stereo matching while SLAM runs
};

}  // namespace headway::pipeline
