// SPDX-License-Identifier: BSD-3-Clause
// Fusion of the depth scans of a tile to at most one point a voxel.
#pragma once

#include <headway/core/scan.h>

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace headway::map {

/// Points of the dense map in one square of the map.
struct DenseTile {
  std::vector<Eigen::Vector3f> positions;            ///< from the corner of the tile [m]
  std::vector<std::array<std::uint8_t, 3>> colours;  ///< red, green, blue
};

/// Voxels along the side of a tile.
inline constexpr int kTileVoxels = 256;

/// A depth scan and the pose of its robot, in order of time.
struct PosedScan {
  std::shared_ptr<const DepthScan> scan;
  Pose T_map_robot = Pose::Identity();
};

/// Fuses the scans of one tile, see DenseMap.
///
/// @param corner  of the tile with the least x and y, z of the map [m]
/// @param scans   that reach into the tile, in order of time
[[nodiscard]] DenseTile fuseTile(const Eigen::Vector2d& corner, double voxel_m,
                                 const std::vector<PosedScan>& scans);

/// Bounds of a scan's points in the robot frame [m]; empty without points.
[[nodiscard]] Eigen::AlignedBox3d boundsOf(const DepthScan& scan);

}  // namespace headway::map
