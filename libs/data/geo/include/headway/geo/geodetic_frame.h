// SPDX-License-Identifier: BSD-3-Clause
// Local frames on the earth (WGS 84).
#pragma once

#include <headway/core/pose.h>

#include <Eigen/Core>
#include <cmath>

namespace headway::geo {

/// A position on WGS 84.
struct GeodeticPosition {
  double latitude_deg = 0.0;   ///< north positive
  double longitude_deg = 0.0;  ///< east positive
  double altitude_m = 0.0;     ///< above the ellipsoid
};

/// A frame with x east, y north and z up at a position on WGS 84.
class GeodeticFrame {
 public:
  GeodeticFrame() = default;
  explicit GeodeticFrame(const GeodeticPosition& origin) : origin_(origin) {}

  [[nodiscard]] const GeodeticPosition& origin() const { return origin_; }
  /// The position in this frame [m].
  [[nodiscard]] Eigen::Vector3d enuOf(const GeodeticPosition& position) const;
  /// Inverse of enuOf().
  [[nodiscard]] GeodeticPosition positionOf(const Eigen::Vector3d& enu) const;

 private:
  [[nodiscard]] GeodeticPosition refined(GeodeticPosition position,
                                         const Eigen::Vector3d& enu) const;

  GeodeticPosition origin_;
};

}  // namespace headway::geo
