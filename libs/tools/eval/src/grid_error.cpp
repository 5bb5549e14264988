// SPDX-License-Identifier: BSD-3-Clause
// Errors of occupancy grids.
#include <headway/eval/figures.h>
#include <headway/eval/grid_error.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace headway::eval {
namespace {

/// Whether a condition holds for a cell or any of its eight neighbours.
template <typename Condition>
bool anyAround(const GridCells& grid, std::size_t index, const Condition& condition) {
  const int column = static_cast<int>(index) % grid.columns;
  const int row = static_cast<int>(index) / grid.columns;
  for (int y = std::max(0, row - 1); y <= std::min(grid.rows - 1, row + 1); ++y) {
    for (int x = std::max(0, column - 1); x <= std::min(grid.columns - 1, column + 1); ++x) {
      if (condition(static_cast<std::size_t>(y * grid.columns + x))) return true;
    }
  }
  return false;
}

/// Whether a cell or any of its eight neighbours is occupied.
bool touchesOccupied(const GridCells& grid, std::size_t index) {
  return anyAround(grid, index,
                   [&](std::size_t i) { return grid.states[i] == CellState::kOccupied; });
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

std::optional<std::size_t> GridCells::at(const Eigen::Vector2d& position) const {
  const double column = std::floor((position.x() - origin.x()) / resolution_m);
  const double row = std::floor((position.y() - origin.y()) / resolution_m);
  if (!(column >= 0.0 && column < columns && row >= 0.0 && row < rows)) return std::nullopt;
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
         static_cast<std::size_t>(column);
}

std::optional<double> VisibleObstacles::judgedRatio() const { return ratioOf(judged, occupied); }
std::optional<double> VisibleObstacles::foundRatio() const { return ratioOf(found, judged); }
std::optional<double> VisibleObstacles::freeAloneRatio() const {
  return ratioOf(free_alone, judged);
}

std::optional<double> GridError::correctRatio() const { return ratioOf(correct, compared); }
std::optional<double> GridError::occupiedRecall() const { return ratioOf(found, occupied); }
std::optional<double> GridError::occupiedPrecision() const {
  return ratioOf(found, found + false_occupied);
}

std::optional<double> GridError::ghostRatio() const { return ratioOf(ghosts, swept); }

std::optional<double> OccupiedPrecision::touchRatio() const { return ratioOf(touching, called); }
std::optional<double> OccupiedPrecision::strictRatio() const { return ratioOf(strict, called); }

OccupiedPrecision occupiedPrecision(const GridCells& truth, const GridCells& estimate,
                                    const std::vector<std::uint8_t>& left_out) {
  if (truth.states.size() != estimate.states.size() || truth.states.size() != left_out.size()) {
    throw std::invalid_argument("occupiedPrecision: the grids have different sizes");
  }
  OccupiedPrecision result;
  for (std::size_t i = 0; i < truth.states.size(); ++i) {
    if (estimate.states[i] != CellState::kOccupied) continue;
    if (left_out[i] != 0) {
      ++result.left_out;
    } else if (truth.states[i] == CellState::kUnknown) {
      ++result.unknown;
    } else {
      ++result.called;
      if (truth.states[i] == CellState::kOccupied) ++result.strict;
      if (touchesOccupied(truth, i)) ++result.touching;
    }
  }
  return result;
}

std::vector<std::uint8_t> rimsOf(const GridCells& grid, const std::vector<std::uint8_t>& drops) {
  std::vector<std::uint8_t> rims(drops.size(), 0);
  for (std::size_t i = 0; i < drops.size(); ++i) {
    rims[i] = drops[i] != 0 && anyAround(grid, i, [&](std::size_t k) { return drops[k] == 0; });
  }
  return rims;
}

GridError gridError(const GridCells& truth, const GridCells& estimate,
                    const std::vector<std::uint8_t>& swept) {
  if (truth.states.size() != estimate.states.size() || truth.states.size() != swept.size()) {
    throw std::invalid_argument("gridError: the grids have different sizes");
  }
  GridError error;
  for (std::size_t i = 0; i < truth.states.size(); ++i) {
    const CellState actual = truth.states[i], estimated = estimate.states[i];
    if (estimated == CellState::kUnknown) {
      if (actual == CellState::kOccupied) ++error.unseen;
      continue;
    }
    ++error.observed;
    if (actual == CellState::kUnknown) continue;
    ++error.compared;
    if (actual == estimated) ++error.correct;
    if (actual == CellState::kOccupied) {
      ++error.occupied;
      if (estimated == CellState::kOccupied) {
        ++error.found;
      } else {
        ++error.false_free;
        if (touchesOccupied(estimate, i)) ++error.near_false_free;
      }
      continue;
    }
    if (swept[i] != 0) ++error.swept;
    if (estimated != CellState::kOccupied) continue;
    ++error.false_occupied;
    const bool near = touchesOccupied(truth, i);
    if (near) ++error.near_false_occupied;
    if (swept[i] != 0 && !near) ++error.ghosts;
  }
  return error;
}

VisibleObstacles visibleObstacles(const GridCells& truth, const GridCells& estimate,
                                  const std::vector<std::uint8_t>& visible) {
  if (truth.states.size() != estimate.states.size() || truth.states.size() != visible.size()) {
    throw std::invalid_argument("visibleObstacles: the grids have different sizes");
  }
  VisibleObstacles result;
  for (std::size_t i = 0; i < truth.states.size(); ++i) {
    if (truth.states[i] != CellState::kOccupied || visible[i] == 0) continue;
    ++result.occupied;
    if (estimate.states[i] == CellState::kUnknown) continue;
    ++result.judged;
    if (estimate.states[i] == CellState::kOccupied) {
      ++result.found;
    } else if (!touchesOccupied(estimate, i)) {
      ++result.free_alone;
    }
  }
  return result;
}

std::size_t markedFree(const GridCells& estimate, const std::vector<std::uint8_t>& marked) {
  if (estimate.states.size() != marked.size()) {
    throw std::invalid_argument("markedFree: the grids have different sizes");
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < marked.size(); ++i) {
    if (marked[i] != 0 && estimate.states[i] == CellState::kFree) ++count;
  }
  return count;
}

}  // namespace headway::eval
