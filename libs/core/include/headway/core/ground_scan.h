#pragma once

#include <Eigen/Core>
#include <vector>

namespace headway {

/// What one look over the ground showed: where it is free, and what stands on it.
///
/// Places are on the ground, in the robot's frame [m]. What is in neither list was not seen.
struct GroundScan {
  /// A straight piece of ground on which nothing stands.
  struct Free {
    Eigen::Vector3f from;
    Eigen::Vector3f to;
  };
  /// The foot of something that stands.
  struct Obstacle {
    Eigen::Vector3f foot;
    float sigma_m;  ///< of its distance
  };

  std::vector<Free> free;
  std::vector<Obstacle> obstacles;

  [[nodiscard]] bool empty() const { return free.empty() && obstacles.empty(); }
};

}  // namespace headway
