// SPDX-License-Identifier: BSD-3-Clause
// Free room on a site's floor and ways through it.
#include "navigation_grid.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <queue>

namespace headway::sim {
namespace {

constexpr double kCell = 0.1;         // [m]
constexpr double kComfortable = 0.7;  // ways keep so far off obstacles where there is room [m]

}  // namespace

NavigationGrid::NavigationGrid(const Site& site) : origin_(site.area.min()) {
  const Eigen::Vector2d size = site.area.sizes() / kCell;
  cv::Mat free(static_cast<int>(size.y()) + 1, static_cast<int>(size.x()) + 1, CV_8U,
               cv::Scalar(255));
  constexpr int kShift = 4;  // binary digits behind the point
  std::vector<Footprint> obstacles = site.obstacles;
  obstacles.insert(obstacles.end(), site.edges.begin(), site.edges.end());
  for (const Spot& spot : site.spots) {  // who stands there does not give way
    if (!spot.seat) obstacles.push_back({spot.position, {0.4, 0.4}, spot.yaw});
  }
  for (const Footprint& footprint : obstacles) {
    const Eigen::Vector2d ex(std::cos(footprint.yaw), std::sin(footprint.yaw));
    const Eigen::Vector2d ey(-ex.y(), ex.x());
    std::vector<cv::Point> corners;
    for (const auto& [x, y] : {std::pair{0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}, {0.5, -0.5}}) {
      const Eigen::Vector2d corner =
          (footprint.centre + x * footprint.size.x() * ex + y * footprint.size.y() * ey - origin_) /
          kCell;
      corners.emplace_back(static_cast<int>(std::lround((corner.x() - 0.5) * (1 << kShift))),
                           static_cast<int>(std::lround((corner.y() - 0.5) * (1 << kShift))));
    }
    cv::fillConvexPoly(free, corners, cv::Scalar(0), cv::LINE_8, kShift);
  }
  cv::rectangle(free, cv::Rect({}, free.size()), cv::Scalar(0), 1);
  cv::distanceTransform(free, clearance_, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  clearance_ *= kCell;
}

cv::Point NavigationGrid::cellAt(const Eigen::Vector2d& at) const {
  const Eigen::Vector2d cell = (at - origin_) / kCell;
  return {static_cast<int>(std::floor(cell.x())), static_cast<int>(std::floor(cell.y()))};
}

Eigen::Vector2d NavigationGrid::middleOf(const cv::Point& cell) const {
  return origin_ + kCell * Eigen::Vector2d(cell.x + 0.5, cell.y + 0.5);
}

double NavigationGrid::clearance(const Eigen::Vector2d& at) const {
  const cv::Point cell = cellAt(at);
  if (!cell.inside(cv::Rect({}, clearance_.size()))) return 0.0;
  return clearance_.at<float>(cell);
}

bool NavigationGrid::isClear(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                             double radius) const {
  const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / (0.5 * kCell))));
  for (int i = 0; i <= steps; ++i) {
    if (clearance(from + (to - from) * i / steps) < radius) return false;
  }
  return true;
}

std::vector<cv::Point> NavigationGrid::search(const cv::Point& start, const cv::Point& goal,
                                              double radius) const {
  const cv::Rect all({}, clearance_.size());
  if (!start.inside(all) || !goal.inside(all)) return {};
  cv::Mat_<float> cost(clearance_.size(), 1e9F);
  cv::Mat_<int> came_from(clearance_.size(), -1);
  using Entry = std::pair<double, int>;  // expected cost, cell
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto index = [&](const cv::Point& cell) { return cell.y * all.width + cell.x; };
  cost(start) = 0.0F;
  open.push({0.0, index(start)});
  while (!open.empty()) {
    const int at = open.top().second;
    open.pop();
    const cv::Point here(at % all.width, at / all.width);
    if (here == goal) break;
    for (int k = 0; k < 9; ++k) {
      const cv::Point next = here + cv::Point(k % 3 - 1, k / 3 - 1);
      if (!next.inside(all)) continue;
      const double room = clearance_.at<float>(next);
      // Who stands too near to an obstacle may still walk away from it.
      if (room < radius && room <= clearance_.at<float>(here)) continue;
      const double length = std::hypot(next.x - here.x, next.y - here.y);
      const double narrow = std::max(0.0, kComfortable - room) / kComfortable;
      const double total = cost(here) + length * (1.0 + 2.0 * narrow);
      if (total >= cost(next) - 1e-4) continue;
      cost(next) = static_cast<float>(total);
      came_from(next) = at;
      open.push({total + std::hypot(next.x - goal.x, next.y - goal.y), index(next)});
    }
  }
  std::vector<cv::Point> cells;
  if (goal != start && came_from(goal) < 0) return cells;
  for (cv::Point at = goal; at != start;) {
    cells.push_back(at);
    const int from = came_from(at);
    at = {from % all.width, from / all.width};
  }
  return cells;
}

std::vector<Eigen::Vector2d> NavigationGrid::straightened(
    const std::vector<Eigen::Vector2d>& points, double radius) const {
  std::vector<Eigen::Vector2d> corners;
  for (std::size_t at = 0; at + 1 < points.size();) {
    std::size_t next = at + 1;
    // A short cut keeps as far off obstacles as the piece that it replaces.
    double room = std::min(kComfortable, clearance(points[at]));
    for (std::size_t i = at + 1; i < std::min(points.size(), at + 150); ++i) {
      room = std::min(room, clearance(points[i]));
      if (isClear(points[at], points[i], std::max(0.0, std::min(room, radius + 0.2) - 0.02))) {
        next = i;
      }
    }
    corners.push_back(points[next]);
    at = next;
  }
  return corners;
}

std::vector<Eigen::Vector2d> NavigationGrid::path(const Eigen::Vector2d& from,
                                                  const Eigen::Vector2d& to, double radius) const {
  const auto cells = search(cellAt(from), cellAt(to), radius);
  if (cells.empty()) return {};
  std::vector<Eigen::Vector2d> points{from};
  for (auto cell = cells.rbegin(); cell != cells.rend(); ++cell) points.push_back(middleOf(*cell));
  points.back() = to;
  return straightened(points, radius);
}

}  // namespace headway::sim
