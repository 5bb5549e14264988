// SPDX-License-Identifier: BSD-3-Clause
// Leads a reactive navigator along a course, round what stands in its way.
#include "guide.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <queue>
#include <utility>

namespace headway::app {
namespace {

using Eigen::Vector2d;

constexpr double kGuideCell_m = 0.1;
constexpr int kGuideReach = 50;  // cells from the robot to the window's sides
constexpr int kGuideSize = 2 * kGuideReach + 1;
constexpr std::size_t kAhead = 4;     // places of the course, a metre apart
constexpr double kGap_m = 0.1;        // beside the robot, at least: a cell
constexpr double kRoom_m = 0.8;       // to the robot's middle; more is worth nothing
constexpr double kLeaving_m = 0.35;   // whoever is that near is left anyhow
constexpr float kCrowded = 2.0F;      // added cost without room: a detour thrice as long
constexpr float kOffCourse = 1.0F;    // added cost a metre beside the course
constexpr double kOffCourse_m = 2.0;  // at most; farther off it waits until the way is free
constexpr float kKept = 0.6F;         // ratio of the cost of the last way
constexpr double kKept_m = 0.3;       // on both sides of it
constexpr float kAsGood = 1.2F;       // ratio of the cost of a straight line to the way's
constexpr float kNoWay = std::numeric_limits<float>::infinity();

const cv::Point kRobotCell(kGuideReach, kGuideReach);

bool isInside(const cv::Point& cell) {
  return cell.x >= 0 && cell.y >= 0 && cell.x < kGuideSize && cell.y < kGuideSize;
}

/// Distance of each cell to the nearest that is 0 [m].
cv::Mat1f distances(const cv::Mat1b& cells) {
  cv::Mat1f distance;
  cv::distanceTransform(cells, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  distance *= kGuideCell_m;
  return distance;
}

float lengthOf(const cv::Point& step) { return static_cast<float>(std::hypot(step.x, step.y)); }

}  // namespace

cv::Point Guide::cellOf(const Vector2d& place) const {
  const Vector2d offset = (place - robot_) / kGuideCell_m;
  constexpr double kFar = 1000.0;  // cells; a course may lie far outside of the window
  return kRobotCell + cv::Point(cvRound(std::clamp(offset.x(), -kFar, kFar)),
                                cvRound(std::clamp(offset.y(), -kFar, kFar)));
}

Vector2d Guide::placeOf(const cv::Point& cell) const {
  const cv::Point offset = cell - kRobotCell;
  return robot_ + kGuideCell_m * Vector2d(offset.x, offset.y);
}

const Vector2d& Guide::lead(const Vector2d& robot, const std::vector<Vector2d>& obstacles) {
  robot_ = robot;
  const std::size_t last = course_.size() - 1, from = passed_;
  for (std::size_t i = from; i <= std::min(last, from + kAhead); ++i) {
    if ((course_[i] - robot).norm() < (course_[passed_] - robot).norm()) passed_ = i;
  }
  target_ = course_[std::min(last, passed_ + 1)];
  const cv::Mat1f cost = costs(obstacles);
  cv::Mat1f kept;
  cv::multiply(cost, cv::Scalar(kKept), kept);
  cost.copyTo(kept, distancesTo(way_.empty() ? course_ : way_) > kKept_m);
  for (std::size_t aimed = std::min(last, passed_ + kAhead); aimed > passed_; --aimed) {
    const cv::Point end = cellOf(course_[aimed]);
    if (!isInside(end) || !(cost(end) < kNoWay)) continue;
    const auto cells = way(kept, end);
    if (cells.empty()) continue;
    way_.clear();
    for (const cv::Point& cell : cells) way_.push_back(placeOf(cell));
    const cv::Point next = farthestAhead(cost, cells);
    target_ = next == end ? course_[aimed] : placeOf(next);
    break;
  }
  return target_;
}

cv::Mat1f Guide::distancesTo(const std::vector<Vector2d>& line) const {
  cv::Mat1b beside(kGuideSize, kGuideSize, uchar{255});
  std::vector<cv::Point> cells;
  for (const Vector2d& place : line) cells.push_back(cellOf(place));
  cv::polylines(beside, cells, false, cv::Scalar(0));
  return distances(beside);
}

cv::Mat1f Guide::costs(const std::vector<Vector2d>& obstacles) const {
  cv::Mat1b free(kGuideSize, kGuideSize, uchar{255});
  for (const Vector2d& place : obstacles) {
    const cv::Point cell = cellOf(place);
    if (isInside(cell)) free(cell) = 0;
  }
  const cv::Mat1f room = distances(free), off_course = distancesTo(course_);
  cv::Mat1f cost(kGuideSize, kGuideSize, kNoWay);
  const double needed = half_width_ + kGap_m;
  const double farthest = std::max<double>(kOffCourse_m, off_course(kRobotCell));
  for (int y = 0; y < kGuideSize; ++y) {
    for (int x = 0; x < kGuideSize; ++x) {
      const cv::Point cell(x, y);
      const bool leaves = kGuideCell_m * lengthOf(cell - kRobotCell) < kLeaving_m;
      const double here = room(cell);
      if (!leaves && (here < needed || off_course(cell) > farthest)) continue;
      const auto crowded =
          static_cast<float>(std::clamp((kRoom_m - here) / (kRoom_m - needed), 0.0, 1.0));
      const auto off = static_cast<float>(std::min<double>(off_course(cell), kOffCourse_m));
      cost(cell) = 1.0F + kCrowded * crowded + kOffCourse * off;
    }
  }
  return cost;
}

std::vector<cv::Point> Guide::way(const cv::Mat1f& costs, const cv::Point& to) {
  static const std::vector<cv::Point> kSteps = {{1, 0}, {-1, 0}, {0, 1},  {0, -1},
                                                {1, 1}, {1, -1}, {-1, 1}, {-1, -1}};
  using Entry = std::pair<float, int>;  // cost to the end, index of a cell
  const auto indexOf = [](const cv::Point& cell) { return cell.y * kGuideSize + cell.x; };
  const auto cellAt = [](int index) { return cv::Point(index % kGuideSize, index / kGuideSize); };
  std::vector<int> next(static_cast<std::size_t>(kGuideSize * kGuideSize), -1);
  cv::Mat1f total(kGuideSize, kGuideSize, kNoWay);
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  total(to) = 0.0F;
  open.push({0.0F, indexOf(to)});
  while (!open.empty()) {
    const auto [cost, index] = open.top();
    open.pop();
    const cv::Point cell = cellAt(index);
    if (cell == kRobotCell) break;
    if (cost > total(cell)) continue;
    for (const cv::Point& step : kSteps) {
      const cv::Point other = cell + step;
      if (!isInside(other)) continue;
      const float through = cost + lengthOf(step) * costs(other);
      if (through >= total(other)) continue;
      total(other) = through;
      next[static_cast<std::size_t>(indexOf(other))] = index;
      open.push({through, indexOf(other)});
    }
  }
  if (total(kRobotCell) == kNoWay) return {};
  std::vector<cv::Point> cells = {kRobotCell};
  while (cells.back() != to) {
    cells.push_back(cellAt(next[static_cast<std::size_t>(indexOf(cells.back()))]));
  }
  return cells;
}

cv::Point Guide::farthestAhead(const cv::Mat1f& costs, const std::vector<cv::Point>& way) {
  cv::Point farthest = way.back();
  float along = 0.0F;
  for (std::size_t i = 1; i < way.size(); ++i) {
    along += lengthOf(way[i] - way[i - 1]) * costs(way[i]);
    float straight = 0.0F;
    const cv::Point to = way[i] - kRobotCell;
    const int steps = std::max(std::abs(to.x), std::abs(to.y));
    for (int k = 1; k <= steps; ++k) {
      const cv::Point cell = kRobotCell + cv::Point(cvRound(static_cast<double>(k) * to.x / steps),
                                                    cvRound(static_cast<double>(k) * to.y / steps));
      straight += lengthOf(to) / static_cast<float>(steps) * costs(cell);
    }
    if (i == 1 || straight <= kAsGood * along) farthest = way[i];
  }
  return farthest;
}

}  // namespace headway::app
