// SPDX-License-Identifier: BSD-3-Clause
// What one frame says about ground, obstacles and surfaces, for the layers of the map.
#pragma once

#include <headway/core/pose.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
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
    float low_m = 0.0F,
          high_m = 0.0F;  ///< heights between which it is seen; 0: unknown. Not stored
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

/// Camera and grid of a depth scan. The cell in column c and row r holds the depth of the pixel
/// (u0 + c * step_u, v0 + r * step_v) of the left image.
struct DepthScanGrid {
  std::int32_t columns = 0, rows = 0;
  double u0 = 0.0, v0 = 0.0, step_u = 1.0, step_v = 1.0;  ///< [px]
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;          ///< of the rectified camera [px]
  double focal_baseline = 0.0;                            ///< disparity times depth [px m]
  double sigma_disparity_px = 0.0;                        ///< noise of a disparity [px]
  Pose T_robot_cam = Pose::Identity();                    ///< left camera on the robot

  [[nodiscard]] std::size_t cells() const {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
};

/// Depth and colour of the static surfaces seen in one frame. Cells without a reliable depth, and
/// those on moving objects, are unknown: nothing follows from them.
struct DepthScan {
  static constexpr double kUnitsPerPx = 64.0;  ///< of the stored disparities

  Time time = -std::numeric_limits<double>::infinity();  ///< of the frame [s]; or long ago
  DepthScanGrid grid;
  std::vector<std::uint8_t> known;       ///< a bit for each cell, row by row, lowest bit first
  std::vector<std::uint16_t> disparity;  ///< of the known cells, row by row [px / kUnitsPerPx]
  std::vector<std::uint8_t> colour;      ///< of the same: grey, or red, green and blue

  [[nodiscard]] bool isKnown(std::size_t cell) const {
    return ((known[cell / 8] >> (cell % 8)) & 1U) != 0;
  }
  [[nodiscard]] bool empty() const { return disparity.empty(); }
  [[nodiscard]] bool hasColour() const { return colour.size() > disparity.size(); }
};

}  // namespace headway
