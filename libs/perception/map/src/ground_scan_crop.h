// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>
#include <headway/core/scan.h>

#include <Eigen/Geometry>

namespace headway::map {

/// What a scan contains within a rectangle of the map; segments are clipped.
[[nodiscard]] GroundScan cropped(const GroundScan& scan, const Pose& T_map_robot,
                                 const Eigen::AlignedBox2d& area);

}  // namespace headway::map
