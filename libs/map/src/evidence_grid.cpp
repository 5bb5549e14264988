// SPDX-License-Identifier: BSD-3-Clause
#include "evidence_grid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

namespace headway::map {
namespace {

using mrpt::maps::COccupancyGridMap2D;

constexpr double kUnit = 16.0;             // evidence per unit of log-odds, as in MRPT's cells
constexpr double kHit = 0.85;              // log-odds of a near obstacle
constexpr double kMinHit = 0.25;           // log-odds of a distant one, of uncertain cell
constexpr std::int32_t kFree = 6;          // evidence of free ground
constexpr std::int32_t kLaserHit = 14;     // evidence of an obstacle of a laser, as kHit
constexpr std::int32_t kMaxEvidence = 72;  // limit of a cell's output
constexpr int kMarginCells = 64;           // minimum growth of the grid
constexpr int kMaxReserve = 512;           // growth of the arrays beyond that
constexpr std::size_t kMaxPublished = 8;   // maps to be published again

/// Evidence of one scan for the cells around it.
class Window {
 public:
  Window(const GroundScan& scan, const Pose& T_map_robot, const RobotFootprint& footprint,
         double resolution)
      : resolution_(resolution) {
    Eigen::AlignedBox2d bounds;
    const auto covered = placesUnder(footprint, T_map_robot);
    for (const auto& place : covered) bounds.extend(place);
    const auto free = segments(scan.free, T_map_robot, bounds);
    const auto passed = segments(scan.laser_passed, T_map_robot, bounds);
    const auto obstacles = feet(scan.obstacles, T_map_robot, bounds);
    const auto laser_obstacles = feet(scan.laser_obstacles, T_map_robot, bounds);
    left = cellOf(bounds.min().x());
    bottom = cellOf(bounds.min().y());
    columns = cellOf(bounds.max().x()) - left + 1;
    rows = cellOf(bounds.max().y()) - bottom + 1;
    evidence.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
    enterFree(free, evidence);
    for (const auto& place : covered) evidence[at(place)] = -kFree;
    for (std::size_t i = 0; i < obstacles.size(); ++i) hit(obstacles[i], scan.obstacles[i]);
    if (!scan.hasLaser()) return;
    laser.assign(evidence.size(), 0);
    enterFree(passed, laser);
    for (const auto& foot : laser_obstacles) {
      laser[at(foot)] = kLaserHit;
      evidence[at(foot)] = std::max(evidence[at(foot)], 0);
    }
  }

  int left, bottom, columns, rows;
  std::vector<std::int32_t> evidence;
  std::vector<std::int32_t> laser;  ///< empty without laser

 private:
  using Segment = std::pair<Eigen::Vector2d, Eigen::Vector2d>;

  static Eigen::Vector2d placeOf(const Eigen::Vector3f& place, const Pose& T_map_robot) {
    return (T_map_robot * place.cast<double>()).head<2>();
  }
  static std::vector<Segment> segments(const std::vector<GroundScan::Free>& pieces,
                                       const Pose& T_map_robot, Eigen::AlignedBox2d& bounds) {
    std::vector<Segment> result;
    result.reserve(pieces.size());
    for (const auto& piece : pieces) {
      result.push_back({placeOf(piece.from, T_map_robot), placeOf(piece.to, T_map_robot)});
      bounds.extend(result.back().first).extend(result.back().second);
    }
    return result;
  }
  static std::vector<Eigen::Vector2d> feet(const std::vector<GroundScan::Obstacle>& obstacles,
                                           const Pose& T_map_robot, Eigen::AlignedBox2d& bounds) {
    std::vector<Eigen::Vector2d> result;
    result.reserve(obstacles.size());
    for (const auto& obstacle : obstacles) {
      result.push_back(placeOf(obstacle.foot, T_map_robot));
      bounds.extend(result.back());
    }
    return result;
  }
  /// Positions in every cell that the footprint meets; it is enlarged by half a cell for those that
  /// it only touches.
  [[nodiscard]] std::vector<Eigen::Vector2d> placesUnder(const RobotFootprint& footprint,
                                                         const Pose& T_map_robot) const {
    std::vector<Eigen::Vector2d> places;
    if (footprint.empty()) return places;
    const double step = 0.25 * resolution_;
    const double half_length = 0.5 * (footprint.length_m + resolution_);
    const double half_width = 0.5 * (footprint.width_m + resolution_);
    for (double x = -half_length; x <= half_length; x += step) {
      for (double y = -half_width; y <= half_width; y += step) {
        places.emplace_back((T_map_robot * Eigen::Vector3d(x, y, 0.0)).head<2>());
      }
    }
    return places;
  }
  [[nodiscard]] int cellOf(double metres) const {
    return static_cast<int>(std::floor(metres / resolution_));
  }
  /// Clamped, because positions between two ends may be rounded to a cell beyond them.
  [[nodiscard]] std::size_t at(const Eigen::Vector2d& place) const {
    const int column = std::clamp(cellOf(place.x()) - left, 0, columns - 1);
    const int row = std::clamp(cellOf(place.y()) - bottom, 0, rows - 1);
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
  void enterFree(const std::vector<Segment>& pieces, std::vector<std::int32_t>& cells) const {
    for (const auto& [from, to] : pieces) {
      const int steps = static_cast<int>(std::ceil(2.0 * (to - from).norm() / resolution_));
      for (int i = 0; i <= steps; ++i) {
        cells[at(from + (steps == 0 ? 0.0 : static_cast<double>(i) / steps) * (to - from))] =
            -kFree;
      }
    }
  }
  void hit(const Eigen::Vector2d& foot, const GroundScan::Obstacle& obstacle) {
    const double certainty = resolution_ / static_cast<double>(obstacle.sigma_m);
    const double weight = std::clamp(kHit * certainty, kMinHit, kHit);
    auto& cell = evidence[at(foot)];
    cell = std::max(cell, static_cast<std::int32_t>(std::lround(kUnit * weight)));
  }

  double resolution_;
};

/// MRPT's cell: log-odds of being free, limited to kMaxEvidence.
COccupancyGridMap2D::cellType shownFor(std::int32_t evidence) {
  static const auto table = [] {
    std::vector<COccupancyGridMap2D::cellType> cells;
    for (std::int32_t value = -kMaxEvidence; value <= kMaxEvidence; ++value) {
      cells.push_back(
          COccupancyGridMap2D::p2l(static_cast<float>(1.0 / (1.0 + std::exp(value / kUnit)))));
    }
    return cells;
  }();
  return table[static_cast<std::size_t>(std::clamp(evidence, -kMaxEvidence, kMaxEvidence) +
                                        kMaxEvidence)];
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

void EvidenceGrid::growTo(int left, int bottom, int right, int top) {
  const bool inside =
      left >= left_ && bottom >= bottom_ && right <= left_ + columns_ && top <= bottom_ + rows_;
  if (inside && columns_ > 0) return;
  if (columns_ > 0) {
    if (left < left_) left -= kMarginCells;
    if (bottom < bottom_) bottom -= kMarginCells;
    if (right > left_ + columns_) right += kMarginCells;
    if (top > bottom_ + rows_) top += kMarginCells;
    left = std::min(left, left_);
    bottom = std::min(bottom, bottom_);
    right = std::max(right, left_ + columns_);
    top = std::max(top, bottom_ + rows_);
  }
  left_ = left;
  bottom_ = bottom;
  columns_ = right - left;
  rows_ = top - bottom;
  published_.clear();  // maps in use belong to their users
  growStorage();
}

/// Makes the arrays hold the grid. They grow by up to half of its size, so that a robot that drives
/// on does not copy the whole grid every few metres.
void EvidenceGrid::growStorage() {
  const Area needed{left_, bottom_, columns_, rows_};
  if (needed.left >= stored_.left && needed.bottom >= stored_.bottom &&
      needed.left + needed.columns <= stored_.left + stored_.columns &&
      needed.bottom + needed.rows <= stored_.bottom + stored_.rows) {
    return;
  }
  const Area old = stored_;
  stored_ = needed;
  if (old.columns > 0) {
    const int wide = std::min(needed.columns / 2, kMaxReserve);
    const int high = std::min(needed.rows / 2, kMaxReserve);
    if (needed.left < old.left) stored_.left -= wide;
    if (needed.bottom < old.bottom) stored_.bottom -= high;
    const bool to_right = needed.left + needed.columns > old.left + old.columns;
    const bool to_top = needed.bottom + needed.rows > old.bottom + old.rows;
    const int right = to_right ? needed.left + needed.columns + wide : old.left + old.columns;
    const int top = to_top ? needed.bottom + needed.rows + high : old.bottom + old.rows;
    stored_.left = std::min(stored_.left, old.left);
    stored_.bottom = std::min(stored_.bottom, old.bottom);
    stored_.columns = right - stored_.left;
    stored_.rows = top - stored_.bottom;
  }
  const auto grow = [&](auto& cells, auto empty) {
    const auto before = std::exchange(cells, {});
    cells.assign(static_cast<std::size_t>(stored_.columns) * static_cast<std::size_t>(stored_.rows),
                 empty);
    for (int row = 0; row < old.rows; ++row) {
      const auto from = before.begin() + static_cast<std::ptrdiff_t>(row) * old.columns;
      std::copy(from, from + old.columns, cells.begin() + indexOf(old.left, row + old.bottom));
    }
  };
  grow(evidence_, std::int32_t{0});
  grow(laser_, std::int32_t{0});
  grow(shown_, shownFor(0));
}

void EvidenceGrid::enter(const GroundScan& scan, const Pose& T_map_robot, int sign) {
  if (scan.empty() && footprint_.empty()) return;
  const Window window(scan, T_map_robot, footprint_, resolution_);
  growTo(window.left, window.bottom, window.left + window.columns, window.bottom + window.rows);
  const Eigen::Vector2i min(window.left - left_, window.bottom - bottom_);
  for (const auto& map : published_) {
    map->outdated.extend(min, min + Eigen::Vector2i(window.columns, window.rows));
  }
  for (int row = 0; row < window.rows; ++row) {
    const auto* from = window.evidence.data() + static_cast<std::ptrdiff_t>(row) * window.columns;
    const auto first = static_cast<std::size_t>(indexOf(window.left, row + window.bottom));
    const auto* laser =
        window.laser.empty()
            ? nullptr
            : window.laser.data() + static_cast<std::ptrdiff_t>(row) * window.columns;
    for (std::size_t column = 0; column < static_cast<std::size_t>(window.columns); ++column) {
      const std::int32_t by_laser = laser == nullptr ? 0 : laser[column];
      if (from[column] == 0 && by_laser == 0) continue;
      const std::size_t cell = first + column;
      evidence_[cell] += sign * from[column];
      laser_[cell] += sign * by_laser;
      shown_[cell] = shownFor(evidence_[cell] + std::max(laser_[cell], 0));
    }
  }
}

std::shared_ptr<EvidenceGrid::Published> EvidenceGrid::unusedMap() const {
  for (const auto& map : published_) {
    if (!map->in_use.load(std::memory_order_acquire)) return map;
  }
  auto map = std::make_shared<Published>();
  const auto edge = [&](int cells) { return static_cast<float>(cells * resolution_); };
  map->grid.setSize(edge(left_), edge(left_ + columns_), edge(bottom_), edge(bottom_ + rows_),
                    static_cast<float>(resolution_), 0.5f);
  map->outdated.extend({0, 0}, {columns_, rows_});
  if (published_.size() < kMaxPublished) published_.push_back(map);
  return map;
}

COccupancyGridMap2D::Ptr EvidenceGrid::grid() const {
  if (columns_ == 0) return nullptr;
  const auto map = unusedMap();
  const Rectangle changed = std::exchange(map->outdated, {});
  for (int row = changed.min.y(); row < changed.end.y(); ++row) {
    const auto from = shown_.begin() + indexOf(left_ + changed.min.x(), bottom_ + row);
    std::copy(from, from + (changed.end.x() - changed.min.x()),
              map->grid.getRow(row) + changed.min.x());
  }
  map->grid.cellsHaveChanged();
  map->in_use.store(true, std::memory_order_relaxed);
  return {&map->grid,
          [map](COccupancyGridMap2D*) { map->in_use.store(false, std::memory_order_release); }};
}

}  // namespace headway::map
