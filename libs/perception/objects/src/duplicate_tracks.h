// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "tracked_object.h"

namespace headway::objects {

/// Suppresses all but the best-scored of tracks of different classes at the same position.
///
/// A detector may detect one person both as a pedestrian and as a cyclist, and each detection
/// starts a separate track.
///
/// @param tracks      in ascending order of ids
/// @param distance_m  below which centres are one position; 0 keeps all [m]
/// @return            those kept, in the same order
[[nodiscard]] std::vector<const TrackedObject*> suppressDuplicateTracks(
    const std::vector<const TrackedObject*>& tracks, double distance_m);

}  // namespace headway::objects
