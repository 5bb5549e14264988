#pragma once

#include <Eigen/Core>
#include <vector>

namespace headway {

/// Free ground and obstacles seen in one frame.
///
/// Positions are on the ground, in the robot's frame [m]. Ground in neither list is unobserved.
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

  [[nodiscard]] bool empty() const { return free.empty() && obstacles.empty(); }
};

}  // namespace headway
