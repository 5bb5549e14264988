// SPDX-License-Identifier: BSD-3-Clause
// Cutting a stored map to a box.
#pragma once

#include <headway/map/map_file.h>

#include <Eigen/Geometry>

namespace headway::map {

/// Cuts a stored map to a box: keyframes, landmarks and moving objects outside of it are removed
/// (see slam::croppedMap()), and of the grid the cells outside of its rectangle. The result can be
/// loaded as any map.
///
/// @param box  in the map frame [m]; of infinite height to keep everything above the rectangle
/// @throws InputError if no keyframe is in the box (stating where they are), or if the map is
///         damaged
[[nodiscard]] StoredMap cropped(const StoredMap& stored, const Eigen::AlignedBox3d& box);

}  // namespace headway::map
