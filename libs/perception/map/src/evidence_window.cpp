// SPDX-License-Identifier: BSD-3-Clause
#include "evidence_window.h"

#include <algorithm>
#include <cmath>

namespace headway::map {
namespace {

constexpr double kHit = 0.85;          // log-odds of a near obstacle
constexpr double kMinHit = 0.25;       // log-odds of a distant one, of uncertain cell
constexpr std::int8_t kFreeHit = 6;    // evidence of free ground
constexpr std::int8_t kLaserHit = 14;  // evidence of an obstacle of a laser, as kHit
constexpr double kMaxCell = 1 << 28;   // from the origin, each way

Eigen::Vector2d placeOf(const Eigen::Vector3f& place, const Pose& T_map_robot) {
  return (T_map_robot * place.cast<double>()).head<2>();
}

}  // namespace

EvidenceGrid::Window::Window(const GroundScan& scan, const Pose& T_map_robot,
                             const RobotFootprint& footprint, double resolution)
    : resolution_(resolution), scan_(scan) {
  under_ = placesUnder(footprint, T_map_robot);
  for (const auto& place : under_) bounds_.extend(place);
  free_ = segments(scan.free, T_map_robot);
  passed_ = segments(scan.laser_passed, T_map_robot);
  obstacles_ = feet(scan.obstacles, T_map_robot);
  laser_obstacles_ = feet(scan.laser_obstacles, T_map_robot);
}

bool EvidenceGrid::Window::fits() const {
  const Eigen::Array2d sides = bounds_.sizes() / resolution_;
  const double farthest =
      std::max(bounds_.min().cwiseAbs().maxCoeff(), bounds_.max().cwiseAbs().maxCoeff());
  return farthest < kMaxCell * resolution_ && (sides + 1.0).prod() <= kMaxCells;
}

EvidenceGrid::Area EvidenceGrid::Window::area() const {
  Area area;
  area.left = cellOf(bounds_.min().x());
  area.bottom = cellOf(bounds_.min().y());
  area.columns = cellOf(bounds_.max().x()) - area.left + 1;
  area.rows = cellOf(bounds_.max().y()) - area.bottom + 1;
  return area;
}

void EvidenceGrid::Window::fill() {
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
    laser[at(foot)] = kLaserHit;
    evidence[at(foot)] = std::max<std::int8_t>(evidence[at(foot)], 0);
  }
}

std::vector<EvidenceGrid::Window::Segment> EvidenceGrid::Window::segments(
    const std::vector<GroundScan::Free>& pieces, const Pose& T_map_robot) {
  std::vector<Segment> result;
  result.reserve(pieces.size());
  for (const auto& piece : pieces) {
    result.push_back({placeOf(piece.from, T_map_robot), placeOf(piece.to, T_map_robot)});
    bounds_.extend(result.back().first).extend(result.back().second);
  }
  return result;
}

std::vector<Eigen::Vector2d> EvidenceGrid::Window::feet(
    const std::vector<GroundScan::Obstacle>& obstacles, const Pose& T_map_robot) {
  std::vector<Eigen::Vector2d> result;
  result.reserve(obstacles.size());
  for (const auto& obstacle : obstacles) {
    result.push_back(placeOf(obstacle.foot, T_map_robot));
    bounds_.extend(result.back());
  }
  return result;
}

std::vector<Eigen::Vector2d> EvidenceGrid::Window::placesUnder(const RobotFootprint& footprint,
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

int EvidenceGrid::Window::cellOf(double metres) const {
  return static_cast<int>(std::floor(metres / resolution_));
}

std::size_t EvidenceGrid::Window::at(const Eigen::Vector2d& place) const {
  const int column = std::clamp(cellOf(place.x()) - area_.left, 0, area_.columns - 1);
  const int row = std::clamp(cellOf(place.y()) - area_.bottom, 0, area_.rows - 1);
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(area_.columns) +
         static_cast<std::size_t>(column);
}

void EvidenceGrid::Window::enterFree(const std::vector<Segment>& pieces,
                                     std::vector<std::int8_t>& cells) const {
  for (const auto& [from, to] : pieces) {
    const int steps = static_cast<int>(std::ceil(2.0 * (to - from).norm() / resolution_));
    for (int i = 0; i <= steps; ++i) {
      cells[at(from + (steps == 0 ? 0.0 : static_cast<double>(i) / steps) * (to - from))] =
          -kFreeHit;
    }
  }
}

void EvidenceGrid::Window::hit(const Eigen::Vector2d& foot, const GroundScan::Obstacle& obstacle) {
  const double certainty = resolution_ / static_cast<double>(obstacle.sigma_m);
  const double weight = std::clamp(kHit * certainty, kMinHit, kHit);
  auto& cell = evidence[at(foot)];
  cell = std::max(cell, static_cast<std::int8_t>(std::lround(kEvidenceUnit * weight)));
}

}  // namespace headway::map
