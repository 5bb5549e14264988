// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

#include <optional>
#include <vector>

namespace headway::geo {

/// A position in two frames whose z axes point up.
struct PositionPair {
  Eigen::Vector3d in_map = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d enu = Eigen::Vector3d::Zero();     ///< measured [m]
  double sigma = 1.0;                                ///< of each horizontal axis [m]
};

/// Turn about the vertical and horizontal shift from a map to the earth.
struct PlanarAlignment {
  double yaw = 0.0;                                 ///< [rad]
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  ///< [m]
  double spread = 1.0;       ///< of the residuals, times the receiver's sigma; at least 1
  std::vector<bool> agrees;  ///< for each pair

  [[nodiscard]] std::size_t agreeing() const;
};

/// Greatest horizontal distance from the first position in the map [m].
[[nodiscard]] double horizontalExtent(const std::vector<PositionPair>& pairs);

/// The alignment on which most pairs agree, with the weighted mean over these; nullopt if the way
/// is too short for any. See georeference().
[[nodiscard]] std::optional<PlanarAlignment> alignPlanar(const std::vector<PositionPair>& pairs);

}  // namespace headway::geo
