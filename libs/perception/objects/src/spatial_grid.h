// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

namespace headway::objects {

/// Positions on the ground plane sorted into square cells, for neighbour queries.
///
/// A query visits nine cells, so that its cost depends on the local density and not on the total
/// number of positions.
class SpatialGrid {
 public:
  /// @param places   anything with a `position` in the map frame
  /// @param cell_m   edge of a cell, the radius of queries; 1 cm at least
  template <typename Placed>
  SpatialGrid(const std::vector<Placed>& places, double cell_m) : cell_m_(std::max(cell_m, 0.01)) {
    entries_.reserve(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto& position = places[i].position;
      entries_.push_back(
          {keyOf(cellOf(position.x()), cellOf(position.y())), i, position.x(), position.y()});
    }
    std::sort(entries_.begin(), entries_.end());
  }

  /// Calls `visit(index)` for every position in the cell of `position` and its eight neighbours:
  /// for all positions within `cell_m`, and some beyond.
  template <typename Visit>
  void visitNear(const Eigen::Vector2d& position, Visit visit) const {
    visitEntries(position, [&](const Entry& entry) { visit(entry.index); });
  }

  /// The same for positions within a radius of at most `cell_m`, read where they are side by side.
  template <typename Visit>
  void visitWithin(const Eigen::Vector2d& position, double radius_m, Visit visit) const {
    visitEntries(position, [&](const Entry& entry) {
      const double x = entry.x - position.x();
      const double y = entry.y - position.y();
      if (x * x + y * y <= radius_m * radius_m) visit(entry.index);
    });
  }

 private:
  static constexpr std::int64_t kMaxCells = std::int64_t{1} << 30;  ///< each way

  struct Entry {
    std::int64_t key;  ///< of the cell
    std::size_t index;
    double x, y;  ///< [m]
    bool operator<(const Entry& other) const {
      return std::tie(key, index) < std::tie(other.key, other.index);
    }
  };

  template <typename Visit>
  void visitEntries(const Eigen::Vector2d& position, Visit visit) const {
    const std::int64_t column = cellOf(position.x());
    const std::int64_t row = cellOf(position.y());
    for (std::int64_t i = column - 1; i <= column + 1; ++i) {
      // Cells of one column have consecutive keys.
      const std::int64_t last = keyOf(i, row + 1);
      auto entry =
          std::lower_bound(entries_.begin(), entries_.end(), Entry{keyOf(i, row - 1), 0, 0.0, 0.0});
      for (; entry != entries_.end() && entry->key <= last; ++entry) visit(*entry);
    }
  }

  [[nodiscard]] std::int64_t cellOf(double coordinate) const {
    const double cell = std::floor(coordinate / cell_m_);
    const double limit = static_cast<double>(kMaxCells);
    return static_cast<std::int64_t>(std::clamp(cell, -limit, limit));
  }
  static std::int64_t keyOf(std::int64_t column, std::int64_t row) {
    return column * 4 * kMaxCells + row;
  }

  double cell_m_;
  std::vector<Entry> entries_;
};

}  // namespace headway::objects
