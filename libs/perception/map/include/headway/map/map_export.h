// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/slam/map_view.h>
#include <mrpt/maps/CPointsMap.h>

#include <string>

namespace headway::map {

/// Writes an MRPT `.simplemap`: for each keyframe its pose with covariance and its visible
/// landmarks as points of a CObservation3DRangeScan (label `landmarks`, robot frame).
///
/// @throws InputError if the file cannot be written
void writeSimpleMap(const std::string& path, const slam::MapView& static_map);

/// Writes the landmarks as a binary PLY point cloud: x, y, z [m] in the map frame, and grey as
/// intensity 0 to 1 (for MRPT) and as red, green, blue (for other programs).
///
/// @throws InputError if the file cannot be written
void writePly(const std::string& path, const slam::MapView& static_map);

/// Writes points as a binary PLY point cloud: x, y, z [m] in the map frame, and red, green, blue.
///
/// @throws InputError if the file cannot be written
void writePly(const std::string& path, const mrpt::maps::CPointsMap& points);

}  // namespace headway::map
