#pragma once

#include <vector>

#include "tracked_object.h"

namespace headway::objects {

/// Suppresses tracks of different classes at the same place, but the one with the best score.
///
/// A detector may report one person both as a pedestrian and as a cyclist, and each report starts a
/// track of its own.
///
/// @param tracks      in ascending order of ids
/// @param distance_m  between centres on the ground of one place; 0 keeps all [m]
/// @return            those kept, in the same order
[[nodiscard]] std::vector<const TrackedObject*> suppressDuplicateTracks(
    const std::vector<const TrackedObject*>& tracks, double distance_m);

}  // namespace headway::objects
