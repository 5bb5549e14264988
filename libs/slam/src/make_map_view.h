#pragma once

#include <headway/slam/map_view.h>

#include "sparse_map.h"

namespace headway::slam {

/// The map as others see it: keyframes are where the robot was, not its camera.
[[nodiscard]] MapView makeMapView(const SparseMap& map, const Pose& T_cam_robot);

}  // namespace headway::slam
