// SPDX-License-Identifier: BSD-3-Clause
// Leads a reactive navigator along a course, round what stands in its way.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway::app {

/// Plans a way from the robot to its course some metres ahead and gives the navigator the farthest
/// place of it that lies straight ahead.
///
/// A reactive navigator alone stops before a group of people that it could go round. The way is the
/// cheapest over a window of cells of 0.1 m, 5 m to each side: it keeps 0.6 m from obstacles where
/// it can, and returns to the course, since walls that are not seen yet are not crossed there. It
/// leaves the course by 2 m at most: who is in the way farther than that is waited for. The way of
/// before is preferred: what closed another one may be out of view, but still there.
/// Without any way the target is the next place of the course.
///
/// @see  Dijkstra 1959, "A note on two problems in connexion with graphs"
class Guide {
 public:
  /// @param course      places about a metre apart, map frame [m]; the goal last
  /// @param robot_width [m]
  Guide(std::vector<Eigen::Vector2d> course, double robot_width)
      : course_(std::move(course)), half_width_(0.5 * robot_width) {}

  /// The place that the robot should drive to now.
  ///
  /// @param robot      map frame [m]
  /// @param obstacles  map frame [m]
  const Eigen::Vector2d& lead(const Eigen::Vector2d& robot,
                              const std::vector<Eigen::Vector2d>& obstacles);

  /// As lead() has returned it last.
  [[nodiscard]] const Eigen::Vector2d& target() const { return target_; }
  [[nodiscard]] bool isLast() const { return target_ == course_.back(); }

 private:
  [[nodiscard]] cv::Point cellOf(const Eigen::Vector2d& place) const;
  [[nodiscard]] Eigen::Vector2d placeOf(const cv::Point& cell) const;
  /// Distance of each cell to a line through places [m].
  [[nodiscard]] cv::Mat1f distancesTo(const std::vector<Eigen::Vector2d>& line) const;
  /// Cost of each cell; infinite where the robot does not fit.
  [[nodiscard]] cv::Mat1f costs(const std::vector<Eigen::Vector2d>& obstacles) const;
  /// Cells from the robot to another; empty if there is no way.
  [[nodiscard]] static std::vector<cv::Point> way(const cv::Mat1f& costs, const cv::Point& to);
  [[nodiscard]] static cv::Point farthestAhead(const cv::Mat1f& costs,
                                               const std::vector<cv::Point>& way);

  std::vector<Eigen::Vector2d> course_;
  double half_width_;
  std::size_t passed_ = 0;
  std::vector<Eigen::Vector2d> way_;                 ///< the last one
  Eigen::Vector2d robot_ = Eigen::Vector2d::Zero();  ///< middle of the window
  Eigen::Vector2d target_ = Eigen::Vector2d::Zero();
};

}  // namespace headway::app
