#pragma once

#include <headway/scene/snapshot.h>

namespace headway::scene {

/// Height of the ground near the robot in the map frame [m], as well as the map tells.
///
/// The middle of the heights on which boxes stand; without boxes near, a low percentile of the
/// landmarks around; without either, the robot's own height.
[[nodiscard]] double groundHeight(const SnapshotInput& input);

}  // namespace headway::scene
