#pragma once

#include "actor.h"
#include "mesh.h"

namespace headway::sim {

/// A car, van, truck or bus, x forward, z up, origin on the ground below its middle [m].
///
/// Its extent is the actor's size: outline extruded over the width, leaning inwards above the belt.
[[nodiscard]] Mesh vehicleMesh(const Actor& actor);

}  // namespace headway::sim
