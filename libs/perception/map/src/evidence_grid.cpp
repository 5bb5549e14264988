// SPDX-License-Identifier: BSD-3-Clause
// Evidence of ground scans in the cells of the occupancy grid, and the grid's growth and
// publication.
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

constexpr std::int32_t kMaxCellEvidence = 72;  // limit of a cell's output
constexpr int kMarginCells = 64;               // minimum growth of the grid
constexpr int kMaxReserve = 512;               // growth of the arrays beyond that
constexpr std::size_t kMaxPublished = 8;       // maps to be published again

constexpr double kEvidenceUnit = 16.0;         // a unit of log-odds, as in MRPT's cells
constexpr double kHit = 0.85, kMinHit = 0.25;  // log-odds of a near obstacle, and of a distant one,
                                               // whose cell is uncertain
constexpr std::int8_t kFreeHit =
    6;  // evidence of free ground: three scans outweigh a near obstacle
// A wrong match is as a rule seen from one place alone: a single hit is shown as unknown, two are
// an obstacle.
constexpr double kShownRatio = 0.7;

std::int8_t evidenceOf(double log_odds) {
  return static_cast<std::int8_t>(std::lround(kEvidenceUnit * log_odds));
}

Eigen::Vector2d placeOf(const Eigen::Vector3f& place, const Pose& T_map_robot) {
  return (T_map_robot * place.cast<double>()).head<2>();
}

}  // namespace

/// Evidence of one scan for the cells around it: here a cell becomes free or occupied.
class EvidenceGrid::Window {
 public:
  /// @param scan  must outlive the window
  Window(const GroundScan& scan, const Pose& T_map_robot, const RobotFootprint& footprint,
         double resolution)
      : resolution_(resolution), scan_(scan), from_(T_map_robot.translation().head<2>()) {
    bounds_.extend(from_);
    addPlacesUnder(footprint, T_map_robot);
    free_ = segments(scan.free, T_map_robot);
    passed_ = segments(scan.laser_passed, T_map_robot);
    obstacles_ = feet(scan.obstacles, T_map_robot);
    laser_obstacles_ = feet(scan.laser_obstacles, T_map_robot);
  }

  [[nodiscard]] bool isFinite() const { return bounds_.sizes().allFinite(); }
  /// Whether the cells can be counted, and sums of their numbers.
  [[nodiscard]] bool fits() const {
    const Eigen::Array2d sides = bounds_.sizes() / resolution_;
    const double farthest =
        std::max(bounds_.min().cwiseAbs().maxCoeff(), bounds_.max().cwiseAbs().maxCoeff());
    return farthest < std::numeric_limits<int>::max() / 8 * resolution_ &&
           (sides + 1.0).prod() <= kMaxCells;
  }
  [[nodiscard]] Area area() const {
    Area area;
    area.left = cellOf(bounds_.min().x());
    area.bottom = cellOf(bounds_.min().y());
    area.columns = cellOf(bounds_.max().x()) - area.left + 1;
    area.rows = cellOf(bounds_.max().y()) - area.bottom + 1;
    return area;
  }

  /// Sets the evidence. The window must fit.
  void fill() {
    area_ = area();
    evidence.assign(static_cast<std::size_t>(area_.columns) * static_cast<std::size_t>(area_.rows),
                    0);
    enterFree(free_, evidence);
    for (const auto& place : under_) evidence[at(place)] = -kFreeHit;
    for (std::size_t i = 0; i < obstacles_.size(); ++i) hit(obstacles_[i], scan_.obstacles[i]);
    if (!scan_.hasLaser()) return;
    laser.assign(evidence.size(), 0);
    enterFree(passed_, laser);
    for (const auto& foot : laser_obstacles_) {
      laser[at(foot)] = evidenceOf(kHit);
      evidence[at(foot)] = std::max<std::int8_t>(evidence[at(foot)], 0);
    }
  }

  std::vector<std::int8_t> evidence;  ///< row by row
  std::vector<std::int8_t> laser;     ///< empty without laser

 private:
  using Segment = std::pair<Eigen::Vector2d, Eigen::Vector2d>;

  std::vector<Segment> segments(const std::vector<GroundScan::Free>& pieces,
                                const Pose& T_map_robot) {
    std::vector<Segment> result;
    result.reserve(pieces.size());
    for (const auto& piece : pieces) {
      result.push_back({placeOf(piece.from, T_map_robot), placeOf(piece.to, T_map_robot)});
      bounds_.extend(result.back().first).extend(result.back().second);
    }
    return result;
  }

  std::vector<Eigen::Vector2d> feet(const std::vector<GroundScan::Obstacle>& obstacles,
                                    const Pose& T_map_robot) {
    std::vector<Eigen::Vector2d> result;
    result.reserve(obstacles.size());
    for (const auto& obstacle : obstacles) {
      result.push_back(placeOf(obstacle.foot, T_map_robot));
      bounds_.extend(result.back());
    }
    return result;
  }

  /// Positions in every cell that the footprint meets; it is enlarged by half a cell for those that
  /// it only touches.
  void addPlacesUnder(const RobotFootprint& footprint, const Pose& T_map_robot) {
    if (footprint.empty()) return;
    const double step = resolution_ / 4;
    const double half_length = 0.5 * (footprint.length_m + resolution_);
    const double half_width = 0.5 * (footprint.width_m + resolution_);
    for (double x = -half_length; x <= half_length; x += step) {
      for (double y = -half_width; y <= half_width; y += step) {
        under_.emplace_back((T_map_robot * Eigen::Vector3d(x, y, 0.0)).head<2>());
        bounds_.extend(under_.back());
      }
    }
  }

  [[nodiscard]] int cellOf(double metres) const {
    return static_cast<int>(std::floor(metres / resolution_));
  }

  /// Clamped, because positions between two ends may be rounded to a cell beyond them.
  [[nodiscard]] std::size_t at(const Eigen::Vector2d& place) const {
    const int column = std::clamp(cellOf(place.x()) - area_.left, 0, area_.columns - 1);
    const int row = std::clamp(cellOf(place.y()) - area_.bottom, 0, area_.rows - 1);
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(area_.columns) +
           static_cast<std::size_t>(column);
  }

  void enterFree(const std::vector<Segment>& pieces, std::vector<std::int8_t>& cells) const {
    for (const auto& [from, to] : pieces) {
      const int steps = static_cast<int>(std::ceil(2.0 * (to - from).norm() / resolution_));
      for (int i = 0; i <= steps; ++i) {
        cells[at(from + (steps == 0 ? 0.0 : static_cast<double>(i) / steps) * (to - from))] =
            -kFreeHit;
      }
    }
  }

  void hit(const Eigen::Vector2d& foot, const GroundScan::Obstacle& obstacle) {
    const double certainty = resolution_ / static_cast<double>(obstacle.sigma_m);
    // A cell that may hold a part of the surface is not free, however much ground it shows.
    const Eigen::Vector2d way = from_ - foot;
    const double uncertain = 0.5 * resolution_ + static_cast<double>(obstacle.sigma_m);
    auto& before = evidence[at(foot + std::min(1.0, uncertain / way.norm()) * way)];
    before = std::max<std::int8_t>(before, 0);
    auto& cell = evidence[at(foot)];
    cell = std::max(cell, evidenceOf(std::clamp(kHit * certainty, kMinHit, kHit)));
  }

  double resolution_;
  const GroundScan& scan_;
  Eigen::Vector2d from_;        ///< the robot
  Eigen::AlignedBox2d bounds_;  ///< of all that follows [m]
  std::vector<Eigen::Vector2d> under_;
  std::vector<Segment> free_, passed_;
  std::vector<Eigen::Vector2d> obstacles_, laser_obstacles_;
  Area area_;
};

namespace {

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

/// The evidence of stereo that is shown.
std::int32_t doubted(std::int32_t evidence) {
  return evidence > 0 ? static_cast<std::int32_t>(kShownRatio * evidence) : evidence;
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
      shown_[cell] = shownFor(doubted(evidence_[cell]) + std::max(laser_[cell], 0));
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
