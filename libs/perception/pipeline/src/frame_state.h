// SPDX-License-Identifier: BSD-3-Clause
// What the stages of the pipeline know about a frame, and what a frame leaves for the next one.
#pragma once

#include <headway/core/recorded_frame.h>
#include <headway/core/statistics.h>
#include <headway/pipeline/perception_update.h>

#include "detection_stage.h"
#include "image_scale.h"

namespace headway::pipeline {

/// A frame's time against that of the frame before.
enum class ClockStep { kAhead, kRepeated, kSetBack };

/// What a frame leaves for the next one.
struct PreviousFrame {
  std::optional<std::size_t> index;     ///< nullopt: there was none
  Time time = 0.0;                      ///< [s]
  Pose T_map_robot = Pose::Identity();  ///< or as predicted
  std::uint64_t revision = 0;           ///< of the map
  std::size_t lost_in_a_row = 0;        ///< frames with images whose camera was lost
  // For motion and tracking, in the odometry frame; empty where the clock was set back.
  std::optional<Pose> T_odom_robot;  ///< if it was tracked
  std::vector<Track> tracks;
  std::vector<ExpectedObject> expected;  ///< in the next frame
  detect::MotionDetections motion;
};

/// All that is known about one frame. Made once, each stage adds its result.
struct FrameState {
  FrameState(const RecordedFrame& recorded, const PreviousFrame& before, const FrameRate& frames,
             const ImageScale& of_images = {})
      : frame(recorded), previous(before), rate(frames), scale(of_images) {}

  const RecordedFrame& frame;
  const PreviousFrame& previous;
  const FrameRate& rate;   ///< with this frame
  const ImageScale scale;  ///< of its images; all boxes here are in their pixels
  ClockStep clock = ClockStep::kAhead;
  std::vector<TrackSample> ended;   ///< of tracks that ended because the clock was set back
  MotionPrior motion_prior;         ///< since the frame before, without what counts from another
  bool is_motion_left_out = false;  ///< of it, for that reason
  bool is_by_slam = false;          ///< not at a recorded pose
  bool scans_ground = false;        ///< it is one of those that are scanned for the grid
  bool scans_local = false;         ///< it is scanned for what is blocked now
  slam::ImageEvidence images = slam::ImageEvidence::kNone;
  std::optional<stereo::FrameContext> context;  ///< rectified; nullopt without images
  ObjectDetections boxes;                       ///< that need no pose
  slam::SlamUpdate camera;
  std::optional<slam::MapView> static_map;  ///< of the camera's submap, if it has changed
  std::vector<int> submaps;                 ///< all there are, with static_map
  /// The robot for motion and tracking: continuous. nullopt unless tracked, at a time of its own.
  std::optional<Pose> T_odom_robot;
  /// The robot in the map, which corrections move. nullopt unless tracked.
  std::optional<Pose> T_map_robot;
  /// The robot's motion since the frame before, in the odometry frame; also where it is too fast to
  /// be true. nullopt if one of both is unknown.
  std::optional<Pose> T_previous_robot;
  FrameDetections found;
  std::optional<stereo::OffsetEstimate> disparity_offset;  ///< measured less true, if it is new
  objects::TrackUpdate objects;                            ///< in the odometry frame
  Findings findings;

  void add(const Findings& more) { findings.insert(findings.end(), more.begin(), more.end()); }
  [[nodiscard]] double secondsSincePrevious() const { return frame.time - previous.time; }
};

}  // namespace headway::pipeline
