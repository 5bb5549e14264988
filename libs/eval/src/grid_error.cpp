#include <headway/eval/grid_error.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace headway::eval {
namespace {

/// Whether any of the eight cells about one is truly occupied.
bool hasOccupiedNeighbour(const GridCells& truth, std::size_t index) {
  const int column = static_cast<int>(index) % truth.columns;
  const int row = static_cast<int>(index) / truth.columns;
  for (int y = std::max(0, row - 1); y <= std::min(truth.rows - 1, row + 1); ++y) {
    for (int x = std::max(0, column - 1); x <= std::min(truth.columns - 1, column + 1); ++x) {
      const auto i = static_cast<std::size_t>(y * truth.columns + x);
      if (truth.states[i] == CellState::kOccupied) return true;
    }
  }
  return false;
}

}  // namespace

GridCells::GridCells(const Eigen::Vector2d& lower_left, double side_m, int column_count,
                     int row_count)
    : origin(lower_left),
      resolution_m(side_m),
      columns(column_count),
      rows(row_count),
      states(static_cast<std::size_t>(column_count) * static_cast<std::size_t>(row_count),
             CellState::kUnknown) {}

std::optional<std::size_t> GridCells::at(const Eigen::Vector2d& place) const {
  const double column = std::floor((place.x() - origin.x()) / resolution_m);
  const double row = std::floor((place.y() - origin.y()) / resolution_m);
  if (!(column >= 0.0 && column < columns && row >= 0.0 && row < rows)) return std::nullopt;
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
         static_cast<std::size_t>(column);
}

std::optional<double> GridError::rightShare() const {
  if (compared == 0) return std::nullopt;
  return static_cast<double>(right) / static_cast<double>(compared);
}

GridError gridError(const GridCells& truth, const GridCells& estimate,
                    const std::vector<std::uint8_t>& trodden) {
  if (truth.states.size() != estimate.states.size() || truth.states.size() != trodden.size()) {
    throw std::invalid_argument("grids of two sizes cannot be compared");
  }
  GridError error;
  for (std::size_t i = 0; i < truth.states.size(); ++i) {
    const CellState is = truth.states[i], seems = estimate.states[i];
    if (seems == CellState::kUnknown) continue;
    ++error.observed;
    if (is == CellState::kUnknown) continue;
    ++error.compared;
    if (is == seems) ++error.right;
    if (is == CellState::kOccupied) {
      ++error.occupied;
      if (seems == CellState::kFree) ++error.missed;
      continue;
    }
    if (trodden[i] != 0) ++error.trodden;
    if (seems != CellState::kOccupied) continue;
    ++error.phantoms;
    const bool near = hasOccupiedNeighbour(truth, i);
    if (near) ++error.near_phantoms;
    if (trodden[i] != 0 && !near) ++error.ghosts;
  }
  return error;
}

}  // namespace headway::eval
