#pragma once

#include <headway/core/ground_scan.h>
#include <headway/core/pose.h>
#include <mrpt/maps/COccupancyGridMap2D.h>

#include <cstdint>
#include <vector>

namespace headway::map {

/// Adds up what looks over the ground say of each cell: for something that stands there, or for
/// free ground.
///
/// A look counts once for a cell, and what stands outweighs what is free. Sums are whole numbers,
/// so that removing a look with the pose it was added at undoes it exactly and the order of looks
/// does not matter. Grows as needed.
///
/// @see  Moravec & Elfes 1985, "High resolution maps from wide angle sonar", for the addition
class EvidenceGrid {
 public:
  explicit EvidenceGrid(double resolution_m) : resolution_(resolution_m) {}

  void add(const GroundScan& scan, const Pose& T_map_robot) { enter(scan, T_map_robot, 1); }
  void remove(const GroundScan& scan, const Pose& T_map_robot) { enter(scan, T_map_robot, -1); }

  /// As MRPT knows it; a cell of which nothing is known is 0.5. Null while there are no cells.
  [[nodiscard]] mrpt::maps::COccupancyGridMap2D::Ptr grid() const;

 private:
  void enter(const GroundScan& scan, const Pose& T_map_robot, int sign);
  void growTo(int left, int bottom, int right, int top);

  double resolution_;
  int left_ = 0;    ///< of the first column, in cells from the map's origin
  int bottom_ = 0;  ///< of the first row
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::int32_t> evidence_;  ///< log-odds of something standing, in 1/16
  std::vector<mrpt::maps::COccupancyGridMap2D::cellType> shown_;  ///< the same, as MRPT has it
};

}  // namespace headway::map
