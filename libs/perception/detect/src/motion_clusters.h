// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>

#include <vector>

#include "point_classification.h"

namespace headway::detect {

/// Points that move together.
struct MotionCluster {
  std::vector<std::size_t> members;                    ///< indices of points, ascending
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< over the ground, world of the path [m/s]
  Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Identity();  ///< [m^2/s^2]
};

/// Parameters of clusterMotion().
struct ClusterParams {
  double reach_m = 1.0;           ///< points nearer than this over the ground are linked [m]
  double reach_per_m = 0.02;      ///< growth of the reach with depth [m/m]
  double speed_difference = 1.0;  ///< and if their velocities differ by less [m/s]
  double speed_ratio = 0.2;       ///< or by this ratio of the speed [-]
  int min_points = 3;
};

/// Joins moving points that are near to each other on the ground and move alike; smaller clusters
/// than `min_points` are left out.
///
/// @param classes  one for each point
/// @param up        unit normal of the ground, in the world of the path
[[nodiscard]] std::vector<MotionCluster> clusterMotion(const std::vector<PointTrack>& points,
                                                       const std::vector<PointClass>& classes,
                                                       const CameraPath& path,
                                                       const Eigen::Vector3d& up,
                                                       const ClusterParams& params);

/// Ratio of moving points among the classified ones inside an object's outline and depth:
/// mismatches on a repetitive structure such as a fence are a minority there. 1 without classified
/// points.
///
/// @param outline   [px]
/// @param nearest   depth of the object's near side [m]
/// @param farthest  and of its far side [m]
[[nodiscard]] double movingRatio(const std::vector<PointTrack>& points,
                                 const std::vector<PointClass>& classes, const CameraPath& path,
                                 const Box2d& outline, double nearest, double farthest);

}  // namespace headway::detect
