// SPDX-License-Identifier: BSD-3-Clause
// Place of a map on the earth by the fixes of a satellite receiver, of which half may be wrong.
#pragma once

#include <headway/core/recorded_frame.h>
#include <headway/geo/geodetic_frame.h>

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

namespace headway::geo {

/// A fix and where the map has its antenna at that time.
struct FixOnMap {
  GnssFix fix;
  Eigen::Vector3d in_map = Eigen::Vector3d::Zero();  ///< map frame [m]
};

/// Where a map lies on the earth.
struct Georeference {
  GeodeticFrame frame;                ///< its origin is the map's
  Pose T_enu_map = Pose::Identity();  ///< a rotation
  /// Of the map's origin (east, north, up [m]) and of the rotation about these axes [rad].
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  std::size_t used = 0;      ///< fixes
  std::size_t rejected = 0;  ///< fixes that contradict the others
  double rmse_m = 0.0;       ///< horizontal, of the fixes used

  /// Direction of the map's x axis, clockwise from north, in [0, 360) [deg].
  [[nodiscard]] double headingDeg() const;
  [[nodiscard]] double headingSigmaDeg() const;
  /// Horizontal standard deviation of the map's origin, both axes together [m].
  [[nodiscard]] double originSigma() const;
  [[nodiscard]] GeodeticPosition positionOf(const Eigen::Vector3d& in_map) const {
    return frame.positionOf(T_enu_map * in_map);
  }
};

/// Why a map cannot be placed, as a sentence without a full stop.
struct NoGeoreference {
  std::string reason;
};

/// When a map can be placed, and what is assumed of receivers.
struct GeoreferenceParams {
  std::size_t min_fixes = 10;          ///< at times with a pose; fewer may agree by chance
  double min_extent_m = 5.0;           ///< of the way, about the error of a receiver [m]
  double max_heading_sigma_deg = 5.0;  ///< of a heading that is reported
  double tilt_sigma_deg = 2.0;         ///< of the map's own level
  double up_over_horizontal = 1.7;     ///< standard deviation of altitudes; of most receivers
  double min_sigma_m = 0.1;            ///< of a position: the map is not more accurate [m]
};

/// Places a map on the earth by heading and position; its scale is kept.
///
/// Heading and horizontal position are those on which most fixes agree (consensus of pairs by the
/// least median of squares), then the weighted mean over all fixes that agree with them within
/// three standard deviations, the receiver's or the observed spread, whichever is greater. Up to
/// half of the fixes may be wrong. Height and tilt follow from the altitudes, the tilt with the
/// map's own level as a prior: it changes where the altitudes say so over a long way,
/// and stays where they do not. The covariance includes the observed spread and the correlation of
/// errors that follow each other.
///
/// @param fixes  in order of time
/// @return       or the reason: fewer than 10 fixes, a way too short for a heading within 5
///               degrees, fixes that contradict the map
/// @see          Rousseeuw & Leroy 1987, "Robust regression and outlier detection", ch. 5
[[nodiscard]] std::variant<Georeference, NoGeoreference> georeference(
    const std::vector<FixOnMap>& fixes, const GeoreferenceParams& params = {});

}  // namespace headway::geo
