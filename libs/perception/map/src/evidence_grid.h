// SPDX-License-Identifier: BSD-3-Clause
// Evidence of ground scans in the cells of the occupancy grid, and the grid's growth and
// publication.
#pragma once

#include <headway/core/pose.h>
#include <headway/core/scan.h>
#include <headway/map/static_grid.h>
#include <mrpt/maps/COccupancyGridMap2D.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace headway::map {

/// Sum of the evidence of ground scans for each cell: occupied or free.
///
/// A scan counts once per cell, as occupied if it has both kinds of evidence, by stereo or laser.
/// The sum of lasers is kept apart and only counts where it is positive, so that beams remove the
/// obstacles of lasers but make no ground free. Sums are integers, so that removing a scan with
/// the pose of its addition is exact and the order of scans does not matter. Grows as needed.
///
/// @see  Moravec & Elfes 1985, "High resolution maps from wide angle sonar", for the addition
class EvidenceGrid {
 public:
  /// @param footprint  free at every pose from which a scan is added
  explicit EvidenceGrid(double resolution_m, const RobotFootprint& footprint = {});
  ~EvidenceGrid();

  /// Of all scans, which decide on the memory: about 9 bytes a cell.
  static constexpr double kMaxCells = 20e6;

  /// False, and nothing is added, if all scans would cover more than kMaxCells.
  [[nodiscard]] bool add(const GroundScan& scan, const Pose& T_map_robot) {
    return enter(scan, T_map_robot, 1);
  }
  void remove(const GroundScan& scan, const Pose& T_map_robot) { enter(scan, T_map_robot, -1); }

  /// As an MRPT map; unobserved cells are 0.5. Null without cells.
  ///
  /// Maps without references elsewhere are published again with the cells that changed since, so
  /// that the cost depends on the changes and not on the area. Maps in use are never changed. To be
  /// called by one thread at a time; the map may be released in any thread.
  [[nodiscard]] mrpt::maps::COccupancyGridMap2D::Ptr grid() const;

 private:
  struct Published;
  struct Area {  ///< in cells from the map's origin
    int left = 0, bottom = 0, columns = 0, rows = 0;
    [[nodiscard]] bool contains(const Area& other) const;
    [[nodiscard]] double cells() const { return static_cast<double>(columns) * rows; }
  };
  class Window;

  bool enter(const GroundScan& scan, const Pose& T_map_robot, int sign);
  [[nodiscard]] static Area united(const Area& a, const Area& b);
  [[nodiscard]] bool growTo(const Area& window);
  void growStorage(const Area& before);
  void copyStorage(const Area& old, const Area& used);
  /// Of a cell in the arrays; row and column from the map's origin.
  [[nodiscard]] std::ptrdiff_t indexOf(int column, int row) const {
    return indexIn(stored_, column, row);
  }
  [[nodiscard]] static std::ptrdiff_t indexIn(const Area& area, int column, int row) {
    return static_cast<std::ptrdiff_t>(row - area.bottom) * area.columns + (column - area.left);
  }
  [[nodiscard]] std::shared_ptr<Published> unusedMap() const;

  double resolution_;
  RobotFootprint footprint_;
  Area covered_;                        ///< by scans
  Area grid_;                           ///< as published; contains that
  Area stored_;                         ///< of the arrays; contains the grid
  std::vector<std::int32_t> evidence_;  ///< log-odds of being occupied, in 1/16
  std::vector<std::int32_t> laser_;     ///< the same of lasers
  std::vector<mrpt::maps::COccupancyGridMap2D::cellType>
      shown_;  ///< the same in MRPT's representation
  mutable std::vector<std::shared_ptr<Published>> published_;  ///< maps of the present size
};

}  // namespace headway::map
