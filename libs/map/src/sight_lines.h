#pragma once

#include <mrpt/maps/COccupancyGridMap2D.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace headway::map {

/// Counts for each cell of a grid how many keyframes saw something in it, and how many saw through
/// it. Independent of the order of keyframes and of the lines in them.
class SightLines {
 public:
  /// @param bounds  of all that will be added [m]
  SightLines(const Eigen::AlignedBox2d& bounds, double resolution_m);

  /// Lines that follow are of one more keyframe: it counts once for each cell.
  void beginKeyframe();
  /// Something stands at `to`, and nothing between `from` and it.
  void occupied(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
  /// Nothing stands between `from` and `to`.
  void free(const Eigen::Vector2d& from, const Eigen::Vector2d& to);

  /// The grid: log-odds of 0.85 for each keyframe that saw something in a cell, less 0.4 for each
  /// that saw through it alone.
  /// @see Moravec & Elfes 1985, "High resolution maps from wide angle sonar", for the addition
  [[nodiscard]] mrpt::maps::COccupancyGridMap2D::Ptr grid() const;

 private:
  struct Cell {
    std::uint16_t hits = 0;
    std::uint16_t misses = 0;
    std::uint32_t last_keyframe = 0;
    bool hit_by_last = false;
  };
  [[nodiscard]] Cell* at(const Eigen::Vector2d& point);
  void hit(Cell& cell);
  void miss(Cell& cell);

  Eigen::Vector2d origin_;
  double resolution_;
  int columns_;
  int rows_;
  std::uint32_t keyframe_ = 0;
  std::vector<Cell> cells_;
};

}  // namespace headway::map
