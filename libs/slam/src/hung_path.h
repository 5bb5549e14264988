#pragma once

#include <headway/slam/map_view.h>

#include <optional>
#include <vector>

#include "sparse_map.h"

namespace headway::slam {

/// Every frame's pose, each hung on a keyframe, so that corrections of the map reach them all.
class HungPath {
 public:
  /// Adds a frame at a camera pose in the map, hung on a keyframe if there is one yet.
  void add(std::size_t frame, Time time, bool tracked, const Pose& T_map_cam,
           const std::optional<KeyframeId>& reference, const SparseMap& map);

  /// Hangs what hangs on one keyframe on another; both are still in the map.
  void handOn(KeyframeId from, KeyframeId to, const SparseMap& map);

  /// The robot at all frames, in order, as the map has them now.
  [[nodiscard]] std::vector<FrameEstimate> estimates(const SparseMap& map,
                                                     const Pose& T_cam_robot) const;

 private:
  struct HungPose {
    std::size_t frame = 0;
    Time time = 0.0;
    bool tracked = false;
    KeyframeId reference;  ///< invalid before the first keyframe: the pose is in the map then
    Pose T_reference_cam = Pose::Identity();
  };
  std::vector<HungPose> poses_;
};

}  // namespace headway::slam
