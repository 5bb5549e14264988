// SPDX-License-Identifier: BSD-3-Clause
// Files of a replay's map.
#pragma once

#include <headway/core/object_class.h>

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

// The map of a replay as its folder's files have it.

namespace headway::report {

/// The occupancy grid as written for map servers.
struct GridFile {
  std::filesystem::path picture;
  double resolution_m = 0.0;                         ///< side of a cell [m]
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< lower left corner, map frame [m]
};

/// A point of the map in its colour.
struct ColouredPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< map frame [m]
  Colour colour{180, 190, 200};
};

/// Reads the points of a binary little-endian PLY file whose vertices start with float x, y, z [m],
/// in the colours of uchar red, green, blue, if it has them.
///
/// Hand-written because MRPT's PLY reader requires OpenGL libraries and loads all points.
///
/// @param max_points  every n-th point is read so that there are no more than these
/// @throws InputError if the file has another format or ends early
[[nodiscard]] std::vector<ColouredPoint> readPoints(const std::filesystem::path& path,
                                                    std::size_t max_points);

/// The number of points that such a file says it has.
///
/// @throws InputError if the file has another format
[[nodiscard]] std::size_t countPoints(const std::filesystem::path& path);

/// Reads the grid's description that headway-replay writes beside its picture; nullopt if there is
/// none.
///
/// @throws InputError if it names no picture or no resolution
[[nodiscard]] std::optional<GridFile> readGrid(const std::filesystem::path& path);

}  // namespace headway::report
