// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace headway {

/// Free ground and obstacles seen in one frame.
///
/// Positions are on the ground, in the robot's frame [m]. Ground in none of the lists is
/// unobserved.
struct GroundScan {
  /// A straight segment of ground without obstacles.
  struct Free {
    Eigen::Vector3f from;
    Eigen::Vector3f to;
  };
  /// The foot point of an obstacle.
  struct Obstacle {
    Eigen::Vector3f foot;
    float sigma_m;  ///< of its distance
  };

  std::vector<Free> free;
  std::vector<Obstacle> obstacles;
  /// Of 2D lasers. A beam that passes over ground does not make it free, because it passes over
  /// lower obstacles, under overhanging ones and over drops; it only shows that obstacles that
  /// lasers saw there before have left.
  std::vector<Obstacle> laser_obstacles;
  std::vector<Free> laser_passed;

  [[nodiscard]] bool hasLaser() const { return !laser_obstacles.empty() || !laser_passed.empty(); }
  [[nodiscard]] bool hasStereo() const { return !free.empty() || !obstacles.empty(); }
  [[nodiscard]] bool empty() const { return !hasStereo() && !hasLaser(); }
};

}  // namespace headway
