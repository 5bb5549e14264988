#include "evidence_grid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace headway::map {
namespace {

using mrpt::maps::COccupancyGridMap2D;

constexpr double kUnit = 16.0;             // evidence per unit of log-odds, as in MRPT's cells
constexpr double kHit = 0.85;              // log-odds of a near obstacle
constexpr double kMinHit = 0.25;           // log-odds of a distant one, of uncertain cell
constexpr std::int32_t kFree = 6;          // evidence of free ground
constexpr std::int32_t kMaxEvidence = 72;  // limit of a cell's output
constexpr int kMarginCells = 64;           // minimum growth of the grid

/// Evidence of one scan for the cells around it.
class Window {
 public:
  Window(const GroundScan& scan, const Pose& T_map_robot, const RobotFootprint& footprint,
         double resolution)
      : resolution_(resolution) {
    Eigen::AlignedBox2d bounds;
    const auto covered = placesUnder(footprint, T_map_robot);
    for (const auto& place : covered) bounds.extend(place);
    for (const auto& piece : scan.free) {
      ends_.push_back(placeOf(piece.from, T_map_robot));
      ends_.push_back(placeOf(piece.to, T_map_robot));
      bounds.extend(ends_[ends_.size() - 2]).extend(ends_.back());
    }
    for (const auto& obstacle : scan.obstacles) {
      feet_.push_back(placeOf(obstacle.foot, T_map_robot));
      bounds.extend(feet_.back());
    }
    left = cellOf(bounds.min().x());
    bottom = cellOf(bounds.min().y());
    columns = cellOf(bounds.max().x()) - left + 1;
    rows = cellOf(bounds.max().y()) - bottom + 1;
    evidence.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
    for (std::size_t i = 0; i + 1 < ends_.size(); i += 2) free(ends_[i], ends_[i + 1]);
    for (const auto& place : covered) at(place) = -kFree;
    for (std::size_t i = 0; i < feet_.size(); ++i) {
      hit(feet_[i], resolution_ / static_cast<double>(scan.obstacles[i].sigma_m));
    }
  }

  int left, bottom, columns, rows;
  std::vector<std::int32_t> evidence;

 private:
  static Eigen::Vector2d placeOf(const Eigen::Vector3f& place, const Pose& T_map_robot) {
    return (T_map_robot * place.cast<double>()).head<2>();
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
  std::int32_t& at(const Eigen::Vector2d& place) {
    const int column = std::clamp(cellOf(place.x()) - left, 0, columns - 1);
    const int row = std::clamp(cellOf(place.y()) - bottom, 0, rows - 1);
    return evidence[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                    static_cast<std::size_t>(column)];
  }
  void free(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const int steps = static_cast<int>(std::ceil(2.0 * (to - from).norm() / resolution_));
    for (int i = 0; i <= steps; ++i) {
      at(from + (steps == 0 ? 0.0 : static_cast<double>(i) / steps) * (to - from)) = -kFree;
    }
  }
  void hit(const Eigen::Vector2d& foot, double certainty) {
    const double weight = std::clamp(kHit * certainty, kMinHit, kHit);
    auto& cell = at(foot);
    cell = std::max(cell, static_cast<std::int32_t>(std::lround(kUnit * weight)));
  }

  double resolution_;
  std::vector<Eigen::Vector2d> ends_;  ///< of free pieces, two by two
  std::vector<Eigen::Vector2d> feet_;
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

}  // namespace

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
  const auto grow = [&](auto& cells, auto empty) {
    auto old = std::exchange(cells, {});
    cells.assign(static_cast<std::size_t>(right - left) * static_cast<std::size_t>(top - bottom),
                 empty);
    for (int row = 0; row < rows_; ++row) {
      const auto from = old.begin() + static_cast<std::ptrdiff_t>(row) * columns_;
      std::copy(from, from + columns_,
                cells.begin() +
                    static_cast<std::ptrdiff_t>(row + bottom_ - bottom) * (right - left) +
                    (left_ - left));
    }
  };
  grow(evidence_, std::int32_t{0});
  grow(shown_, shownFor(0));
  left_ = left;
  bottom_ = bottom;
  columns_ = right - left;
  rows_ = top - bottom;
}

void EvidenceGrid::enter(const GroundScan& scan, const Pose& T_map_robot, int sign) {
  if (scan.empty() && footprint_.empty()) return;
  const Window window(scan, T_map_robot, footprint_, resolution_);
  growTo(window.left, window.bottom, window.left + window.columns, window.bottom + window.rows);
  for (int row = 0; row < window.rows; ++row) {
    const auto* from = window.evidence.data() + static_cast<std::ptrdiff_t>(row) * window.columns;
    const auto first = static_cast<std::size_t>(row + window.bottom - bottom_) *
                           static_cast<std::size_t>(columns_) +
                       static_cast<std::size_t>(window.left - left_);
    for (std::size_t column = 0; column < static_cast<std::size_t>(window.columns); ++column) {
      if (from[column] == 0) continue;
      std::int32_t& evidence = evidence_[first + column];
      evidence += sign * from[column];
      shown_[first + column] = shownFor(evidence);
    }
  }
}

COccupancyGridMap2D::Ptr EvidenceGrid::grid() const {
  if (columns_ == 0) return nullptr;
  auto grid = COccupancyGridMap2D::Create();
  const auto edge = [&](int cells) { return static_cast<float>(cells * resolution_); };
  grid->setSize(edge(left_), edge(left_ + columns_), edge(bottom_), edge(bottom_ + rows_),
                static_cast<float>(resolution_), 0.5f);
  for (int row = 0; row < rows_; ++row) {
    const auto from = shown_.begin() + static_cast<std::ptrdiff_t>(row) * columns_;
    std::copy(from, from + columns_, grid->getRow(row));
  }
  return grid;
}

}  // namespace headway::map
