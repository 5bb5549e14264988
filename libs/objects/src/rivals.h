#pragma once

#include <vector>

#include "tracked_object.h"

namespace headway::objects {

/// Leaves out tracks that stand where another kind of object is surer to stand.
///
/// A detector may report one person both as a pedestrian and as a cyclist, and each report makes a
/// track of its own. Two objects of different kinds cannot be in one place: the track with the
/// better score is kept.
///
/// @param tracks      in ascending order of ids
/// @param distance_m  between centres on the ground: nearer is one place; 0 keeps all [m]
/// @return            those kept, in the same order
[[nodiscard]] std::vector<const TrackedObject*> withoutRivals(
    const std::vector<const TrackedObject*>& tracks, double distance_m);

}  // namespace headway::objects
