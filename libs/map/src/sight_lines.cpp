#include "sight_lines.h"

#include <algorithm>
#include <cmath>

namespace headway::map {
namespace {

constexpr double kHitLogOdds = 0.85;
constexpr double kMissLogOdds = 0.4;
constexpr double kMostLogOdds = 4.5;
constexpr double kMarginCells = 2.0;
/// Freed only so far from what was seen [m]: landmarks lie loosely along a wall, and lines that end
/// on one of them would free the gaps before it.
constexpr double kStandOffM = 0.6;
constexpr std::uint16_t kMostCounted = 60000;

}  // namespace

SightLines::SightLines(const Eigen::AlignedBox2d& bounds, double resolution_m)
    : resolution_(resolution_m) {
  const auto lowest = [&](double edge) {
    return resolution_ * (std::floor(edge / resolution_) - kMarginCells);
  };
  const auto cellsFrom = [&](double origin, double edge) {
    return static_cast<int>(std::ceil((edge - origin) / resolution_ + kMarginCells));
  };
  origin_ = {lowest(bounds.min().x()), lowest(bounds.min().y())};
  columns_ = cellsFrom(origin_.x(), bounds.max().x());
  rows_ = cellsFrom(origin_.y(), bounds.max().y());
  cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
}

void SightLines::beginKeyframe() { ++keyframe_; }

SightLines::Cell* SightLines::at(const Eigen::Vector2d& point) {
  const int column = static_cast<int>(std::floor((point.x() - origin_.x()) / resolution_));
  const int row = static_cast<int>(std::floor((point.y() - origin_.y()) / resolution_));
  if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return nullptr;
  return &cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                 static_cast<std::size_t>(column)];
}

void SightLines::hit(Cell& cell) {
  const bool counted = cell.last_keyframe == keyframe_;
  if (counted && cell.hit_by_last) return;
  if (counted) --cell.misses;  // what this keyframe saw in the cell outweighs what it saw through
  if (cell.hits < kMostCounted) ++cell.hits;
  cell.last_keyframe = keyframe_;
  cell.hit_by_last = true;
}

void SightLines::miss(Cell& cell) {
  if (cell.last_keyframe == keyframe_) return;
  if (cell.misses < kMostCounted) ++cell.misses;
  cell.last_keyframe = keyframe_;
  cell.hit_by_last = false;
}

void SightLines::occupied(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const double length = (to - from).norm();
  const double stand_off = std::max(kStandOffM, resolution_);
  if (length > stand_off) free(from, to - stand_off / length * (to - from));
  if (Cell* cell = at(to)) hit(*cell);
}

void SightLines::free(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const int steps = static_cast<int>(std::ceil(2.0 * (to - from).norm() / resolution_));
  for (int i = 0; i <= steps; ++i) {
    const double share = steps == 0 ? 0.0 : static_cast<double>(i) / steps;
    if (Cell* cell = at(from + share * (to - from))) miss(*cell);
  }
}

mrpt::maps::COccupancyGridMap2D::Ptr SightLines::grid() const {
  auto grid = mrpt::maps::COccupancyGridMap2D::Create();
  const auto toFloat = [](double value) { return static_cast<float>(value); };
  grid->setSize(toFloat(origin_.x()), toFloat(origin_.x() + columns_ * resolution_),
                toFloat(origin_.y()), toFloat(origin_.y() + rows_ * resolution_),
                toFloat(resolution_), 0.5f);
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const Cell& cell = cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                                static_cast<std::size_t>(column)];
      if (cell.hits == 0 && cell.misses == 0) continue;
      const double log_odds = std::clamp(kHitLogOdds * cell.hits - kMissLogOdds * cell.misses,
                                         -kMostLogOdds, kMostLogOdds);
      grid->setCell(column, row, toFloat(1.0 / (1.0 + std::exp(log_odds))));
    }
  }
  return grid;
}

}  // namespace headway::map
