#include <headway/eval/grid_error.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace headway::eval {
namespace {

/// Whether any of the eight cells about one is occupied.
bool hasOccupiedNeighbour(const GridCells& grid, std::size_t index) {
  const int column = static_cast<int>(index) % grid.columns;
  const int row = static_cast<int>(index) / grid.columns;
  for (int y = std::max(0, row - 1); y <= std::min(grid.rows - 1, row + 1); ++y) {
    for (int x = std::max(0, column - 1); x <= std::min(grid.columns - 1, column + 1); ++x) {
      const auto i = static_cast<std::size_t>(y * grid.columns + x);
      if (grid.states[i] == CellState::kOccupied) return true;
    }
  }
  return false;
}

std::optional<double> shareOf(std::size_t part, std::size_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
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

std::optional<double> GridError::rightShare() const { return shareOf(right, compared); }
std::optional<double> GridError::occupiedRecall() const { return shareOf(found, occupied); }
std::optional<double> GridError::occupiedPrecision() const {
  return shareOf(found, found + phantoms);
}

GridError gridError(const GridCells& truth, const GridCells& estimate,
                    const std::vector<std::uint8_t>& trodden) {
  if (truth.states.size() != estimate.states.size() || truth.states.size() != trodden.size()) {
    throw std::invalid_argument("grids of two sizes cannot be compared");
  }
  GridError error;
  for (std::size_t i = 0; i < truth.states.size(); ++i) {
    const CellState is = truth.states[i], seems = estimate.states[i];
    if (seems == CellState::kUnknown) {
      if (is == CellState::kOccupied) ++error.unseen;
      continue;
    }
    ++error.observed;
    if (is == CellState::kUnknown) continue;
    ++error.compared;
    if (is == seems) ++error.right;
    if (is == CellState::kOccupied) {
      ++error.occupied;
      if (seems == CellState::kOccupied) {
        ++error.found;
      } else {
        ++error.missed;
        if (hasOccupiedNeighbour(estimate, i)) ++error.near_missed;
      }
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
