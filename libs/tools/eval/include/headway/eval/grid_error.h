// SPDX-License-Identifier: BSD-3-Clause
// Errors of occupancy grids.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

namespace headway::eval {

/// Occupancy of one ground cell.
enum class CellState : std::uint8_t { kUnknown, kFree, kOccupied };

/// Grid of square ground cells, row-major from the lower left corner, x to the right.
struct GridCells {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< outer corner of the first cell [m]
  double resolution_m = 0.2;
  int columns = 0;
  int rows = 0;
  std::vector<CellState> states;  ///< columns x rows

  GridCells() = default;
  /// Creates a grid whose cells are all unknown.
  GridCells(const Eigen::Vector2d& lower_left, double side_m, int column_count, int row_count);

  /// Index of the cell that contains a position [m]; nullopt outside the grid.
  [[nodiscard]] std::optional<std::size_t> at(const Eigen::Vector2d& position) const;
};

/// Obstacles among the cells of a grid that were visible under a condition, such as a distance.
struct VisibleObstacles {
  std::size_t occupied = 0;    ///< truly occupied cells
  std::size_t judged = 0;      ///< of these, estimated as free or occupied
  std::size_t found = 0;       ///< of the judged, estimated as occupied
  std::size_t free_alone = 0;  ///< of the judged, estimated as free without an occupied cell beside

  [[nodiscard]] std::optional<double> judgedRatio() const;     ///< of occupied; nullopt if none
  [[nodiscard]] std::optional<double> foundRatio() const;      ///< of judged; nullopt if none
  [[nodiscard]] std::optional<double> freeAloneRatio() const;  ///< of judged; nullopt if none
};

/// Comparison of an estimated occupancy grid with its truth.
///
/// Only cells observed in the estimate whose truth is known are compared, cell by cell and without
/// tolerance: a wall displaced by one cell counts as two wrong cells.
struct GridError {
  std::size_t observed = 0;             ///< estimated as free or occupied
  std::size_t compared = 0;             ///< observed cells with known truth
  std::size_t correct = 0;              ///< compared cells in the true state
  std::size_t false_occupied = 0;       ///< estimated as occupied, truly free
  std::size_t near_false_occupied = 0;  ///< of these, next to a truly occupied cell
  std::size_t false_free = 0;           ///< estimated as free, truly occupied
  std::size_t near_false_free = 0;      ///< of these, next to a cell estimated as occupied
  std::size_t occupied = 0;             ///< compared cells that are truly occupied
  std::size_t found = 0;                ///< of these, estimated as occupied
  std::size_t unseen = 0;               ///< truly occupied, not observed
  std::size_t swept = 0;                ///< compared, truly free cells that a moving object covered
  std::size_t ghosts = 0;  ///< of these, estimated as occupied away from true obstacles

  /// ghosts / swept: what moving objects left behind; nullopt if none was compared.
  [[nodiscard]] std::optional<double> ghostRatio() const;
  /// correct / compared; nullopt if no cell was compared.
  [[nodiscard]] std::optional<double> correctRatio() const;
  /// found / occupied; nullopt if no compared cell is truly occupied.
  [[nodiscard]] std::optional<double> occupiedRecall() const;
  /// found / (found + false_occupied); nullopt if no compared cell is estimated as occupied.
  [[nodiscard]] std::optional<double> occupiedPrecision() const;
};

/// How right the cells are that a map calls occupied, with touch: a cell is right if it or one of
/// its eight neighbours is truly occupied.
struct OccupiedPrecision {
  std::size_t called = 0;    ///< estimated as occupied, of known truth
  std::size_t strict = 0;    ///< of these, truly occupied
  std::size_t touching = 0;  ///< of these, truly occupied or next to a truly occupied cell
  std::size_t unknown = 0;   ///< estimated as occupied, of unknown truth: not among `called`
  std::size_t left_out = 0;  ///< estimated as occupied where the truth does not count: neither

  [[nodiscard]] std::optional<double> touchRatio() const;   ///< of called; nullopt if none
  [[nodiscard]] std::optional<double> strictRatio() const;  ///< of called; nullopt if none
  /// Called occupied with no obstacle beside them.
  [[nodiscard]] std::size_t phantoms() const { return called - touching; }
};

/// @param left_out  1 for each cell that is neither obstacle nor free, else 0; one per cell
/// @throws std::invalid_argument if the sizes differ
[[nodiscard]] OccupiedPrecision occupiedPrecision(const GridCells& truth, const GridCells& estimate,
                                                  const std::vector<std::uint8_t>& left_out);

/// Cells of a drop that border other ground: where a robot would fall.
///
/// @param drops  1 for each cell that is lower than the ground, else 0; one per cell of the grid
[[nodiscard]] std::vector<std::uint8_t> rimsOf(const GridCells& grid,
                                               const std::vector<std::uint8_t>& drops);

/// @param swept  1 for each cell that a moving object covered at some time, else 0; one per cell
/// @throws std::invalid_argument if the sizes differ
[[nodiscard]] GridError gridError(const GridCells& truth, const GridCells& estimate,
                                  const std::vector<std::uint8_t>& swept);

/// @param visible  1 for each cell to be counted, else 0; one per cell
/// @throws std::invalid_argument if the sizes differ
[[nodiscard]] VisibleObstacles visibleObstacles(const GridCells& truth, const GridCells& estimate,
                                                const std::vector<std::uint8_t>& visible);

/// Marked cells that are estimated as free.
///
/// @throws std::invalid_argument if the sizes differ
[[nodiscard]] std::size_t markedFree(const GridCells& estimate,
                                     const std::vector<std::uint8_t>& marked);

/// Heights above the ground between which a surface is an obstacle [m].
struct ObstacleHeights {
  double min_m = 0.3;
  double max_m = 2.0;
  double low_m = 0.3;  ///< from here to min_m a surface may be called an obstacle, or not
};

/// Depths between which the rig claims to see obstacles [m].
struct ObstacleReach {
  double from_m = 0.0;
  double to_m = 40.0;
};

/// Errors of a replay's occupancy grid, with the cells that were compared.
struct GridEvaluation {
  GridCells estimate;
  GridCells truth;
  std::vector<std::uint8_t> swept;  ///< 1: a moving object covered the cell at some time
  ObstacleHeights heights;
  ObstacleReach reach;  ///< that the replay claims
  GridError error;
  OccupiedPrecision precision;  ///< rims of drops are obstacles; people and movers do not count
  VisibleObstacles in_reach;    ///< obstacles that were visible within the reach
  VisibleObstacles ahead;       ///< and those that were visible at 0.5 to 3 m
  std::size_t drops = 0;        ///< cells lower than the ground
  std::size_t drops_free = 0;   ///< of these, estimated as free
};

/// Evaluates a replay as `headway-eval grid` does.
///
/// @param truth    folder written by headway-sim --depth --masks
/// @param replay   with map_grid.gridmap.gz and calibration.yaml
/// @param heights  of obstacles; 0: as in the replay
/// @throws InputError if a file is missing or its size differs from the camera's
[[nodiscard]] GridEvaluation evaluateGrid(const std::filesystem::path& truth,
                                          const std::filesystem::path& replay,
                                          const ObstacleHeights& heights);

/// The figures of `headway-eval grid --json`.
[[nodiscard]] nlohmann::ordered_json toJson(const GridEvaluation& evaluation);

}  // namespace headway::eval
