#pragma once

#include "mesh.h"
#include "mover.h"

namespace headway::sim {

/// A car, van, truck or bus, x forward, z up, origin on the ground below its middle [m].
///
/// Its extent is the mover's size: outline extruded over the width, leaning inwards above the belt.
[[nodiscard]] Mesh vehicleMesh(const Mover& mover);

}  // namespace headway::sim
