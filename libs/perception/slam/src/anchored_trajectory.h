// SPDX-License-Identifier: BSD-3-Clause
// The poses of all frames, each stored relative to a keyframe, so that corrections of the map move
// them.
#pragma once

#include <headway/core/ids.h>
#include <headway/core/record_log.h>
#include <headway/slam/map_view.h>

#include <map>
#include <optional>
#include <unordered_map>

#include "sparse_map.h"

namespace headway::slam {

/// A keyframe that was removed: frames that were anchored to it belong to another one.
struct Reassignment {
  KeyframeId from, to;
  StoredPose T_to_from;
};

/// The keyframes that were removed in a run.
class Reassignments {
 public:
  void add(const Reassignment& one) { by_keyframe_[one.from] = one; }

  /// Expresses a pose in the keyframe to which the frames of a removed `reference` belong now.
  void follow(KeyframeId& reference, StoredPose& T_reference_cam) const;

 private:
  std::unordered_map<KeyframeId, Reassignment> by_keyframe_;  // ids are not used again
};

/// The pose of every frame, stored relative to a keyframe so that map corrections apply to it.
///
/// Memory is bounded: older frames are in a temporary file, with the keyframes of their time, and
/// the reassignments since then are applied when the trajectory is read.
class AnchoredTrajectory {
 public:
  /// @param in_memory  frames that stay in memory
  explicit AnchoredTrajectory(std::size_t in_memory) : frames_(in_memory), moved_(in_memory) {}

  /// Adds a frame, anchored to a keyframe if one exists yet.
  void add(std::size_t frame, Time time, bool tracked, const Pose& T_map_cam,
           const std::optional<KeyframeId>& reference, const SparseMap& map);

  /// Anchors the frames of one keyframe to another; both must still be in the map.
  void reassign(KeyframeId from, KeyframeId to, const SparseMap& map);

  /// A keyframe was adjusted when it was made: the frames since the last one, anchored to `from`,
  /// follow in proportion to time, for 2 s at most, so that the path has no step at the new one.
  ///
  /// @param tracked, adjusted  the new keyframe's pose in `from`, before and after
  /// @param time               of the new keyframe [s]
  void followAdjustment(KeyframeId from, const Pose& tracked, const Pose& adjusted, Time time);

  /// Scales the way from each keyframe to its frames, after the map got another scale. Frames that
  /// are in the file keep theirs.
  ///
  /// @param ratios  new scale to old one, by keyframe
  void scale(const std::map<KeyframeId, double>& ratios);

  /// The robot's poses of all frames so far, in the map as it is now, for any thread.
  [[nodiscard]] TrajectoryVisit snapshot(const SparseMap& map, const Pose& T_cam_robot) const;

 private:
  struct AnchoredPose {
    std::size_t frame;
    Time time;
    KeyframeId reference;  ///< invalid before the first keyframe; the pose is then in the map frame
    StoredPose T_reference_cam;
    bool tracked;
  };

  RecordLog<AnchoredPose> frames_;
  RecordLog<Reassignment> moved_;  ///< while frames in the file were anchored to the keyframe
};

}  // namespace headway::slam
