#pragma once

#include <vector>

#include "actor.h"
#include "mesh.h"

namespace headway::sim {

/// The mesh of any actor, placed in the world relative to `origin`.
[[nodiscard]] Mesh actorMesh(const Actor& actor, const Eigen::Vector3d& origin);
[[nodiscard]] std::vector<Mesh> actorMeshes(const std::vector<Actor>& actors,
                                            const Eigen::Vector3d& origin);

}  // namespace headway::sim
