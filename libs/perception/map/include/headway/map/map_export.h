// SPDX-License-Identifier: BSD-3-Clause
// Files of the map for other programs: simplemap, PLY, grids for MRPT and map servers.
#pragma once

#include <headway/core/pose.h>
#include <headway/map/map_file.h>
#include <headway/slam/map_view.h>
#include <mrpt/maps/CPointsMap.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/serialization/CSerializable.h>

#include <filesystem>
#include <string>

namespace headway::map {

/// Thresholds of ROS' map_server, of the probability that a cell is occupied.
inline constexpr double kMaxFree = 0.196, kMinOccupied = 0.65;

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

/// Writes `<prefix>.gridmap.gz` (MRPT), and `<prefix>.png` with `<prefix>.yaml` (map servers).
///
/// @throws InputError if a file cannot be written
void writeStaticGrid(const std::string& prefix, const mrpt::maps::COccupancyGridMap2D& grid);

/// Writes map.headway, and what other programs read of it: map.simplemap, map_points.ply and the
/// files of the grid, if there is one.
///
/// @throws InputError if a file cannot be written
void writeMapFiles(const std::filesystem::path& folder, StoredMap stored);

/// The same of the static layers alone, without map.headway and map.simplemap.
///
/// @param suffix  of the files' names: map_grid<suffix>, map_points<suffix>.ply, ...
void writeMapLayers(const std::filesystem::path& folder, const PerceptionMap& map,
                    const std::string& suffix = "");

/// Writes an MRPT object as its own saveToFile() does, gz-compressed, and reports every write
/// error, which MRPT's gz streams do not.
///
/// @throws InputError if the file cannot be written; an older one then remains
void writeObject(const std::string& path, const mrpt::serialization::CSerializable& object);

/// A pose with covariance in MRPT's parameters (x, y, z, yaw, pitch, roll), in the map frame.
///
/// headway's perturbation is on the right, T exp(xi); to first order a rotation in the robot's axes
/// changes the angles by the inverse of MRPT's Euler rates. These are unbounded near pitch =
/// +-90 deg, where the angles are not defined.
[[nodiscard]] mrpt::poses::CPose3DPDFGaussian toMrptPdf(const Pose& T_map_robot,
                                                        const PoseCovariance& covariance);

}  // namespace headway::map
