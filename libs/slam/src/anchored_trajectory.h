// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/record_log.h>
#include <headway/slam/map_view.h>
#include <headway/slam/trajectory_record.h>

#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "reassignments.h"
#include "sparse_map.h"

namespace headway::slam {

/// The pose of every frame, stored relative to a keyframe so that map corrections apply to it.
///
/// Memory is bounded: older frames are in a temporary file, with the keyframes of their time, and
/// the reassignments since then are applied when the trajectory is read.
class AnchoredTrajectory {
 public:
  /// @param in_memory  frames that stay in memory
  explicit AnchoredTrajectory(std::size_t in_memory) : frames_(in_memory), moved_(in_memory) {}

  /// Calls back with each step from now on, so that restore() can repeat them.
  void setLog(TrajectoryLog log) { log_ = std::move(log); }

  /// Adds a frame, anchored to a keyframe if one exists yet.
  void add(std::size_t frame, Time time, bool tracked, const Pose& T_map_cam,
           const std::optional<KeyframeId>& reference, const SparseMap& map);

  /// Anchors the frames of one keyframe to another; both must still be in the map.
  void reassign(KeyframeId from, KeyframeId to, const SparseMap& map);

  /// Scales the way from each keyframe to its frames, after the map got another scale. Frames that
  /// are in the file keep theirs, as do those of a run that is continued from its log.
  ///
  /// @param ratios  new scale to old one, by keyframe
  void scale(const std::map<KeyframeId, double>& ratios);

  /// The pose of a frame in the current map, of its camera.
  struct Anchored {
    Time time;
    Pose T_map_cam;
    KeyframeId reference;  ///< invalid before the first keyframe
    bool tracked;
  };
  /// nullopt if the frame is not among the newest ones in memory.
  [[nodiscard]] std::optional<Anchored> find(std::size_t frame, const SparseMap& map) const;
  /// Index of the newest frame; nullopt before the first one.
  [[nodiscard]] std::optional<std::size_t> lastFrame() const;

  /// Repeats the steps of a run in an empty trajectory.
  ///
  /// @throws InputError if they are damaged, not in order, or the newest frames are anchored to no
  ///         keyframe of the map
  void restore(const TrajectoryReader& next, const SparseMap& map);

  /// Calls back with the robot poses of all frames, in order, in the current map.
  void visit(const SparseMap& map, const Pose& T_cam_robot,
             const std::function<void(const FrameEstimate&)>& callback) const;

 private:
  struct AnchoredPose {
    std::size_t frame;
    Time time;
    KeyframeId reference;  ///< invalid before the first keyframe; the pose is then in the map frame
    StoredPose T_reference_cam;
    bool tracked;
  };
  [[nodiscard]] Reassignments reassignments() const;

  RecordLog<AnchoredPose> frames_;
  RecordLog<Reassignment> moved_;  ///< while frames in the file were anchored to the keyframe
  TrajectoryLog log_;
};

}  // namespace headway::slam
