#pragma once

#include <headway/slam/map_view.h>

#include <string>

namespace headway::map {

/// Writes an MRPT `.simplemap`: for each keyframe its pose with covariance, and the landmarks that
/// it sees as a CObservationPointCloud (label `landmarks`, robot frame).
///
/// @throws InputError if the file cannot be written
void writeSimpleMap(const std::string& path, const slam::MapView& still_world);

/// Writes the landmarks as a binary PLY point cloud: x, y, z [m] in the map frame, and grey as
/// red, green, blue.
///
/// @throws InputError if the file cannot be written
void writePly(const std::string& path, const slam::MapView& still_world);

}  // namespace headway::map
