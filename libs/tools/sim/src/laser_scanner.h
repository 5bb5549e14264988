// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/random.h>
#include <headway/sim/simulator.h>

#include <vector>

#include "environment.h"

namespace headway::sim {

/// A 2D laser scanner on the robot: its plane cuts the meshes of everything around.
///
/// Times of flight are taken at one instant; a real scanner takes them in turn.
class LaserScanner {
 public:
  LaserScanner(const LaserParams& params, std::uint64_t seed);

  /// @param statics       static surfaces around the robot
  /// @param actor_meshes  of all actors around, relative to the robot's position
  [[nodiscard]] LaserScan scan(Time time, const Pose& T_world_robot,
                               const std::vector<PlacedMesh>& statics,
                               const std::vector<Mesh>& actor_meshes);

 private:
  /// The segment in which a triangle crosses the scan's plane, as the nearest ranges of its rays.
  void cut(const std::array<Eigen::Vector3d, 3>& triangle, std::vector<double>& ranges) const;
  void addSegment(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                  std::vector<double>& ranges) const;

  LaserParams params_;
  Random random_;
  Pose T_robot_laser_ = Pose::Identity();
};

}  // namespace headway::sim
