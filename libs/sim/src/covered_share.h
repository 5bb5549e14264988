#pragma once

#include <headway/core/stereo_camera.h>

#include <vector>

#include "mover.h"

namespace headway::sim {

/// Share of the left image that the bodies cover, as if nothing still stood before them.
///
/// Found without drawing, so that what moves never depends on what is drawn.
[[nodiscard]] double coveredShare(const std::vector<Mover>& movers, const Pose& T_world_robot,
                                  const StereoCamera& camera);

}  // namespace headway::sim
