#pragma once

#include "actor.h"
#include "mesh.h"

namespace headway::sim {

/// A walking (or standing) person, x forward, z up, origin on the ground below the hips [m].
///
/// Hips, knees, shoulders and elbows swing with actor.gait; how far depends on actor.speed.
/// @see Winter 1991, "The Biomechanics and Motor Control of Human Gait": hip about +-25 degrees
///      and knee up to 60 degrees at normal speed
[[nodiscard]] Mesh personMesh(const Actor& actor);

/// A cyclist: bicycle and pedalling rider, origin on the ground below the middle.
[[nodiscard]] Mesh cyclistMesh(const Actor& actor);

/// A person on a chair, x forward, z up, origin on the ground below the knees' middle [m].
[[nodiscard]] Mesh seatedMesh(const Actor& actor);

/// A bicycle alone, origin on the ground below the middle.
[[nodiscard]] Mesh bicycleMesh(int look);

}  // namespace headway::sim
