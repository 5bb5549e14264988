#pragma once

#include <headway/slam/map_view.h>

#include <optional>
#include <vector>

#include "sparse_map.h"

namespace headway::slam {

/// The pose of every frame, stored relative to a keyframe so that map corrections apply to it.
class AnchoredTrajectory {
 public:
  /// Adds a frame, anchored to a keyframe if one exists yet.
  void add(std::size_t frame, Time time, bool tracked, const Pose& T_map_cam,
           const std::optional<KeyframeId>& reference, const SparseMap& map);

  /// Anchors the frames of one keyframe to another; both must still be in the map.
  void reassign(KeyframeId from, KeyframeId to, const SparseMap& map);

  /// Robot poses of all frames, in order, in the current map.
  [[nodiscard]] std::vector<FrameEstimate> estimates(const SparseMap& map,
                                                     const Pose& T_cam_robot) const;

 private:
  struct AnchoredPose {
    std::size_t frame = 0;
    Time time = 0.0;
    bool tracked = false;
    KeyframeId reference;  ///< invalid before the first keyframe; the pose is then in the map frame
    Pose T_reference_cam = Pose::Identity();
  };
  std::vector<AnchoredPose> poses_;
};

}  // namespace headway::slam
