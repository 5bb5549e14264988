// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/scan.h>
#include <headway/core/track.h>

#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace headway::map {

/// The points of a scan inside of a box of the map [m].
[[nodiscard]] DepthScan cropped(const DepthScan& scan, const Pose& T_map_robot,
                                const Eigen::AlignedBox3d& box);

/// Upright box of an object in the odometry frame, at some time.
struct UprightBox {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d size = Eigen::Vector3d::Zero();    ///< length, width, height [m]
  double yaw = 0.0;                                  ///< [rad]
  double margin_m = 0.0;                             ///< by which the object may extend beyond it
};

/// Box of a track at an earlier time, by its smoothed path, and before that by its first velocity,
/// but no farther back than it has been followed since, and at most a second.
///
/// @return  nullopt where its path is not known
[[nodiscard]] std::optional<UprightBox> pastBox(const Track& track, Time time);

/// A scan without the cells in boxes of the same frame, which are enlarged by three standard
/// deviations of the depth.
///
/// @return  nullopt if no cell is in them
[[nodiscard]] std::optional<DepthScan> without(const DepthScan& scan, const Pose& T_odom_robot,
                                               const std::vector<UprightBox>& boxes);

}  // namespace headway::map
