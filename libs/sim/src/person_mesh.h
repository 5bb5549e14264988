#pragma once

#include <vector>

#include "mesh.h"
#include "mover.h"

namespace headway::sim {

/// A walking (or standing) person, x forward, z up, origin on the ground below the hips [m].
///
/// Hips, knees, shoulders and elbows swing with mover.gait; how far depends on mover.speed.
/// @see Winter 1991, "The Biomechanics and Motor Control of Human Gait": hip about +-25 degrees
///      and knee up to 60 degrees at normal speed
[[nodiscard]] Mesh personMesh(const Mover& mover);

/// A cyclist: bicycle and pedalling rider, origin on the ground below the middle.
[[nodiscard]] Mesh cyclistMesh(const Mover& mover);

/// The mesh of any mover, placed in the world relative to `origin`.
[[nodiscard]] Mesh moverMesh(const Mover& mover, const Eigen::Vector3d& origin);
[[nodiscard]] std::vector<Mesh> moverMeshes(const std::vector<Mover>& movers,
                                            const Eigen::Vector3d& origin);

}  // namespace headway::sim
