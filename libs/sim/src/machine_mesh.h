#pragma once

#include "actor.h"
#include "mesh.h"

namespace headway::sim {

/// A counterbalanced forklift with a driver's cage, x forward, z up, origin on the ground below its
/// middle [m]. Its extent, forks included, is the actor's size.
[[nodiscard]] Mesh forkliftMesh(const Actor& actor);

/// A small six-wheeled delivery robot with a flag.
[[nodiscard]] Mesh deliveryRobotMesh(const Actor& actor);

}  // namespace headway::sim
