#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace headway::eval {

/// What is known of one cell of the ground.
enum class CellState : std::uint8_t { kUnknown, kFree, kOccupied };

/// The ground as square cells, row by row from the lower left corner, x to the right.
struct GridCells {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< outer corner of the first cell [m]
  double resolution_m = 0.2;
  int columns = 0;
  int rows = 0;
  std::vector<CellState> states;  ///< columns x rows

  GridCells() = default;
  /// All unknown.
  GridCells(const Eigen::Vector2d& lower_left, double side_m, int column_count, int row_count);

  /// Index of the cell that holds a place; nullopt outside the grid.
  [[nodiscard]] std::optional<std::size_t> at(const Eigen::Vector2d& place) const;
};

/// A grid of free and occupied cells against its truth.
///
/// Only cells that the estimate has observed and of which the truth is known are compared, each
/// strictly with its own truth: a wall found one cell off makes two wrong cells.
struct GridError {
  std::size_t observed = 0;       ///< cells that the estimate calls free or occupied
  std::size_t compared = 0;       ///< of these, with known truth
  std::size_t right = 0;          ///< of the compared
  std::size_t phantoms = 0;       ///< occupied in the estimate, truly free
  std::size_t near_phantoms = 0;  ///< of these, with a truly occupied neighbour
  std::size_t missed = 0;         ///< free in the estimate, truly occupied
  std::size_t near_missed = 0;    ///< of these, with a neighbour that the estimate calls occupied
  std::size_t occupied = 0;       ///< truly occupied, of the compared
  std::size_t found = 0;          ///< of these, occupied in the estimate
  std::size_t unseen = 0;         ///< truly occupied, not observed by the estimate
  std::size_t trodden = 0;        ///< compared cells, truly free, over which something moved
  std::size_t ghosts = 0;         ///< of these, occupied in the estimate: trails left behind

  /// 0 to 1; nullopt where nothing was compared.
  [[nodiscard]] std::optional<double> rightShare() const;
  /// Of what stands in observed cells, the share that is found; nullopt where nothing stands.
  [[nodiscard]] std::optional<double> occupiedRecall() const;
  /// Of what is called occupied, the share that is; nullopt where nothing is called so.
  [[nodiscard]] std::optional<double> occupiedPrecision() const;
};

/// @param trodden  1 for each cell over which something moved; as many as cells
/// @throws std::invalid_argument if the grids are not of one size
[[nodiscard]] GridError gridError(const GridCells& truth, const GridCells& estimate,
                                  const std::vector<std::uint8_t>& trodden);

/// Estimate and truth from above, x to the right, what is wrong in colour. 8-bit BGR.
[[nodiscard]] cv::Mat gridPlot(const GridCells& truth, const GridCells& estimate,
                               const std::vector<std::uint8_t>& trodden);

}  // namespace headway::eval
