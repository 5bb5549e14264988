// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/pipeline/perception.h>

#include <map>
#include <mutex>
#include <vector>

#include "input_health.h"
#include "localisation.h"
#include "mapping.h"

namespace headway::pipeline {

/// Where the odometry frame was in the map at the frames in which tracks may still be smoothed, so
/// that their samples are in the map as it was published then.
class OdometryHistory {
 public:
  void add(std::size_t frame, const Pose& T_map_odom);
  /// Samples of frames that were added, from the odometry frame.
  void moveIntoMap(std::vector<TrackSample>& samples) const;

 private:
  static constexpr std::size_t kMaxFrames = 1000;  ///< several smoothing windows of the longest
  std::map<std::size_t, Pose> poses_;
};

/// The stages of the pipeline, each with the state that it keeps from frame to frame, and what the
/// previous frame left.
class Perception::Implementation {
 public:
  Implementation(std::shared_ptr<const StereoCamera> rig, const PerceptionParams& params,
                 map::PerceptionMap map);

  [[nodiscard]] PerceptionUpdate process(const RecordedFrame& frame);
  /// Moves the run into a joint map: its static layers become those of its part. @return T_map_run
  [[nodiscard]] Pose moveInto(const slam::KeyframePoses& poses);

  std::shared_ptr<const StereoCamera> camera;  ///< null if only poses and boxes are given
  InputHealth health;
  Localisation localisation;
  DetectionStage detection;
  objects::MovingObjectTracker tracker;
  OdometryHistory odometry;
  Mapping mapping;
  LogSink log;
  PerceptionCallbacks callbacks;
  StageTimes times;
  std::mutex change_mutex;
  std::optional<RuntimeParams> change;  ///< for the next frame; guarded by change_mutex

 private:
  void requireUsable(const RecordedFrame& frame) const;
  void applyChange();
  [[nodiscard]] FrameState begin(const RecordedFrame& frame);
  /// Discards what refers to the times before. @return ended tracks
  [[nodiscard]] std::vector<TrackSample> restart();
  [[nodiscard]] std::optional<stereo::FrameContext> rectify(const FrameState& state);
  void localise(FrameState& state);
  [[nodiscard]] FrameDetections detect(const FrameState& state);
  [[nodiscard]] objects::TrackUpdate track(const FrameState& state);
  /// The results of the frame, after the host was called back with them.
  [[nodiscard]] PerceptionUpdate published(FrameState&& state,
                                           const map::PerceptionMap& before) const;
  void write(LogLevel level, const FrameState& state, const std::string& text) const;
  void logFrame(const FrameState& state) const;

  PreviousFrame previous_;
  double max_box_range_m_ = RuntimeParams().max_box_range_m;
};

}  // namespace headway::pipeline
