// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/eval/true_surface.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace headway::eval {

/// Box of a true object in one frame, in the map.
struct ObjectBox {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d size = Eigen::Vector3d::Zero();    ///< length, width, height [m]
  double yaw = 0.0;                                  ///< [rad]
  bool moves = false;                                ///< the object moves in this or another frame
};

/// How much of the true surface has points of a dense map.
struct Coverage {
  std::size_t surface = 0;             ///< patches seen in at least 3 frames within reach
  std::size_t covered_within_bar = 0;  ///< with a point within the bar along its ray as well
  std::size_t covered = 0;             ///< of these, with a point within a voxel's side
  std::size_t matchable = 0;           ///< of the surface, of true stereo depth in 3 frames or more
  std::size_t matchable_covered = 0;

  [[nodiscard]] std::optional<double> ratio() const;             ///< covered / surface
  [[nodiscard]] std::optional<double> ratioWithinBar() const;    ///< covered_within_bar / surface
  [[nodiscard]] std::optional<double> matchableRatio() const;    ///< matchable / surface
  [[nodiscard]] std::optional<double> matchableCovered() const;  ///< matchable_covered / matchable
};

/// Comparison of a dense map with the true surface, in the frame of the map and without alignment:
/// errors of the poses count.
struct DenseError {
  static constexpr std::size_t kRanges = 4;  ///< of equal width, up to the reach

  std::size_t points = 0;
  std::size_t on_still_objects = 0;  ///< of objects that never move, whose surface is not known
  std::size_t compared = 0;          ///< all others
  double median_m = 0.0;             ///< distance to the surface, of the compared points [m]
  double median_bar_m = 0.0;   ///< larger of half a voxel and half the depth error at the least
                               ///< depth that the surface was seen at [m]
  std::size_t within_bar = 0;  ///< points whose distance is at most their bar
  std::size_t astray = 0;      ///< points more than 5 voxels from any surface
  std::size_t of_movers = 0;   ///< more than 4 bars from any surface, where a moving object was
  Coverage coverage;
  std::array<Coverage, kRanges> by_range;   ///< by the least depth that the surface was seen at
  std::vector<std::uint8_t> is_covered;     ///< of each patch: 0 no, 1 yes, 2 not within reach
  std::vector<std::uint32_t> mover_points;  ///< indices of the points of_movers

  [[nodiscard]] std::optional<double> withinBarRatio() const;  ///< of compared
  [[nodiscard]] std::optional<double> moverRatio() const;      ///< of points
};

/// @param patches           of a surface with that voxel and reach
/// @param sigma_per_square  depth error by the square of the depth [1/m]
/// @param points            of the dense map [m]
/// @param objects           what may move, in all frames
[[nodiscard]] DenseError denseError(const std::vector<TrueSurface::Patch>& patches, double voxel_m,
                                    double reach_m, double sigma_per_square,
                                    const std::vector<Eigen::Vector3d>& points,
                                    const std::vector<ObjectBox>& objects);

}  // namespace headway::eval
