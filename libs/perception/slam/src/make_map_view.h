// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/slam/map_view.h>

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "sparse_map.h"

namespace headway::slam {

/// Makes views of a map that grows: what did not change since the view before is shared with it.
///
/// Keyframes of a view are where the robot was, not its camera.
class MapViewMaker {
 public:
  explicit MapViewMaker(const Pose& T_cam_robot) : T_cam_robot_(T_cam_robot) {}

  /// @param map     the same in each call, or one that was loaded in its place after reset()
  /// @param submap  whose landmarks and keyframes are in the view
  [[nodiscard]] MapView make(SparseMap& map, int submap);
  void reset() {
    landmarks_.clear();
    keyframes_.clear();
  }

 private:
  template <typename View>
  using Groups = std::map<std::int64_t, std::shared_ptr<const std::vector<View>>>;

  Pose T_cam_robot_;
  int submap_ = 0;
  Groups<LandmarkView> landmarks_;
  Groups<KeyframeView> keyframes_;
};

/// A single view.
[[nodiscard]] MapView makeMapView(const SparseMap& map, const Pose& T_cam_robot, int submap);

}  // namespace headway::slam
