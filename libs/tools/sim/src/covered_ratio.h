// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <vector>

#include "actor.h"

namespace headway::sim {

/// Ratio of the left image that the meshes cover, as if nothing static stood before them.
///
/// Found without drawing, so that what moves never depends on what is drawn.
[[nodiscard]] double coveredRatio(const std::vector<Actor>& actors, const Pose& T_world_robot,
                                  const StereoCamera& camera);

}  // namespace headway::sim
