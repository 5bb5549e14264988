// SPDX-License-Identifier: BSD-3-Clause
#include "evidence_grid.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "evidence_window.h"

namespace headway::map {
namespace {

using mrpt::maps::COccupancyGridMap2D;

constexpr std::int32_t kMaxCellEvidence = 72;  // limit of a cell's output
constexpr int kMarginCells = 64;               // minimum growth of the grid
constexpr int kMaxReserve = 512;               // growth of the arrays beyond that
constexpr std::size_t kMaxPublished = 8;       // maps to be published again

/// MRPT's cell: log-odds of being free, limited to kMaxCellEvidence.
COccupancyGridMap2D::cellType shownFor(std::int32_t evidence) {
  static const auto table = [] {
    std::vector<COccupancyGridMap2D::cellType> cells;
    for (std::int32_t value = -kMaxCellEvidence; value <= kMaxCellEvidence; ++value) {
      const double free = 1.0 / (1.0 + std::exp(value / kEvidenceUnit));
      cells.push_back(COccupancyGridMap2D::p2l(static_cast<float>(free)));
    }
    return cells;
  }();
  return table[static_cast<std::size_t>(std::clamp(evidence, -kMaxCellEvidence, kMaxCellEvidence) +
                                        kMaxCellEvidence)];
}

/// Columns and rows from `min` to before `end`; empty if there are none.
struct Rectangle {
  Eigen::Vector2i min = Eigen::Vector2i::Constant(std::numeric_limits<int>::max());
  Eigen::Vector2i end = Eigen::Vector2i::Constant(std::numeric_limits<int>::lowest());

  void extend(const Eigen::Vector2i& other_min, const Eigen::Vector2i& other_end) {
    min = min.cwiseMin(other_min);
    end = end.cwiseMax(other_end);
  }
};

/// A grid whose likelihood field is computed anew after a change of cells.
class ChangedGrid : public COccupancyGridMap2D {
 public:
  void cellsHaveChanged() { m_likelihoodCacheOutDated = true; }
};

}  // namespace

/// A published map and the cells that have changed since.
struct EvidenceGrid::Published {
  ChangedGrid grid;
  Rectangle outdated;
  std::atomic<bool> in_use{true};  ///< released by the last user, in any thread
};

EvidenceGrid::EvidenceGrid(double resolution_m, const RobotFootprint& footprint)
    : resolution_(resolution_m), footprint_(footprint) {}
EvidenceGrid::~EvidenceGrid() = default;

bool EvidenceGrid::Area::contains(const Area& other) const {
  return other.left >= left && other.bottom >= bottom &&
         other.left + other.columns <= left + columns && other.bottom + other.rows <= bottom + rows;
}

EvidenceGrid::Area EvidenceGrid::united(const Area& a, const Area& b) {
  if (a.columns == 0) return b;
  Area both;
  both.left = std::min(a.left, b.left);
  both.bottom = std::min(a.bottom, b.bottom);
  both.columns = std::max(a.left + a.columns, b.left + b.columns) - both.left;
  both.rows = std::max(a.bottom + a.rows, b.bottom + b.rows) - both.bottom;
  return both;
}

bool EvidenceGrid::growTo(const Area& window) {
  const Area covered = united(covered_, window);
  if (covered.cells() > kMaxCells) return false;
  covered_ = covered;
  if (grid_.columns > 0 && grid_.contains(window)) return true;
  Area grown = united(grid_, window);
  if (grid_.columns > 0) {
    const auto margin = [](bool grows) { return grows ? kMarginCells : 0; };
    const int left = margin(window.left < grid_.left);
    const int bottom = margin(window.bottom < grid_.bottom);
    const int right = margin(window.left + window.columns > grid_.left + grid_.columns);
    const int top = margin(window.bottom + window.rows > grid_.bottom + grid_.rows);
    grown = {grown.left - left, grown.bottom - bottom, grown.columns + left + right,
             grown.rows + bottom + top};
  }
  const Area before = std::exchange(grid_, grown.cells() <= kMaxCells ? grown : covered);
  published_.clear();  // maps in use belong to their users
  growStorage(before);
  return true;
}

/// Makes the arrays hold the grid. They grow by up to half of its size, so that a robot that drives
/// on does not copy the whole grid every few metres.
void EvidenceGrid::growStorage(const Area& before) {
  if (stored_.contains(grid_)) return;
  const Area old = stored_;
  stored_ = grid_;
  if (old.columns > 0) {
    const int wide = std::min(grid_.columns / 2, kMaxReserve);
    const int high = std::min(grid_.rows / 2, kMaxReserve);
    Area reserved = united(old, grid_);
    const bool to_right = reserved.left + reserved.columns > old.left + old.columns;
    const bool to_top = reserved.bottom + reserved.rows > old.bottom + old.rows;
    if (reserved.left < old.left) {
      reserved.left -= wide;
      reserved.columns += wide;
    }
    if (reserved.bottom < old.bottom) {
      reserved.bottom -= high;
      reserved.rows += high;
    }
    if (to_right) reserved.columns += wide;
    if (to_top) reserved.rows += high;
    if (reserved.cells() <= kMaxCells) stored_ = reserved;
  }
  copyStorage(old, before);
}

/// Makes the arrays anew, with the cells that they had.
///
/// @param used  the grid before, a part of the arrays; the others hold nothing
void EvidenceGrid::copyStorage(const Area& old, const Area& used) {
  // Only what both grids have: margins are empty.
  const int left = std::max(used.left, grid_.left);
  const int right = std::min(used.left + used.columns, grid_.left + grid_.columns);
  const int bottom = std::max(used.bottom, grid_.bottom);
  const int top = std::min(used.bottom + used.rows, grid_.bottom + grid_.rows);
  const auto grow = [&](auto& cells, auto empty) {
    const auto before = std::exchange(cells, {});
    cells.assign(static_cast<std::size_t>(stored_.columns) * static_cast<std::size_t>(stored_.rows),
                 empty);
    if (right <= left) return;
    for (int row = bottom; row < top; ++row) {
      const auto from = before.begin() + indexIn(old, left, row);
      std::copy(from, from + (right - left), cells.begin() + indexIn(stored_, left, row));
    }
  };
  grow(evidence_, std::int32_t{0});
  grow(laser_, std::int32_t{0});
  grow(shown_, shownFor(0));
}

bool EvidenceGrid::enter(const GroundScan& scan, const Pose& T_map_robot, int sign) {
  if (scan.empty() && footprint_.empty()) return true;
  Window window(scan, T_map_robot, footprint_, resolution_);
  if (!window.isFinite()) return true;  // nowhere
  if (!window.fits()) return false;
  const Area area = window.area();
  if (!growTo(area)) return false;
  window.fill();
  const Eigen::Vector2i min(area.left - grid_.left, area.bottom - grid_.bottom);
  for (const auto& map : published_) {
    map->outdated.extend(min, min + Eigen::Vector2i(area.columns, area.rows));
  }
  for (int row = 0; row < area.rows; ++row) {
    const auto* from = window.evidence.data() + static_cast<std::ptrdiff_t>(row) * area.columns;
    const auto first = static_cast<std::size_t>(indexOf(area.left, row + area.bottom));
    const auto* laser = window.laser.empty()
                            ? nullptr
                            : window.laser.data() + static_cast<std::ptrdiff_t>(row) * area.columns;
    for (std::size_t column = 0; column < static_cast<std::size_t>(area.columns); ++column) {
      const std::int32_t by_laser = laser == nullptr ? 0 : laser[column];
      if (from[column] == 0 && by_laser == 0) continue;
      const std::size_t cell = first + column;
      evidence_[cell] += sign * from[column];
      laser_[cell] += sign * by_laser;
      shown_[cell] = shownFor(evidence_[cell] + std::max(laser_[cell], 0));
    }
  }
  return true;
}

std::shared_ptr<EvidenceGrid::Published> EvidenceGrid::unusedMap() const {
  for (const auto& map : published_) {
    if (!map->in_use.load(std::memory_order_acquire)) return map;
  }
  auto map = std::make_shared<Published>();
  const auto edge = [&](int cells) { return static_cast<float>(cells * resolution_); };
  map->grid.setSize(edge(grid_.left), edge(grid_.left + grid_.columns), edge(grid_.bottom),
                    edge(grid_.bottom + grid_.rows), static_cast<float>(resolution_), 0.5f);
  map->outdated.extend({0, 0}, {grid_.columns, grid_.rows});
  if (published_.size() < kMaxPublished) published_.push_back(map);
  return map;
}

COccupancyGridMap2D::Ptr EvidenceGrid::grid() const {
  if (grid_.columns == 0) return nullptr;
  const auto map = unusedMap();
  const Rectangle changed = std::exchange(map->outdated, {});
  for (int row = changed.min.y(); row < changed.end.y(); ++row) {
    const auto from = shown_.begin() + indexOf(grid_.left + changed.min.x(), grid_.bottom + row);
    std::copy(from, from + (changed.end.x() - changed.min.x()),
              map->grid.getRow(row) + changed.min.x());
  }
  map->grid.cellsHaveChanged();
  map->in_use.store(true, std::memory_order_relaxed);
  return {&map->grid,
          [map](COccupancyGridMap2D*) { map->in_use.store(false, std::memory_order_release); }};
}

}  // namespace headway::map
