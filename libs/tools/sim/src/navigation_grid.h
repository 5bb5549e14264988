// SPDX-License-Identifier: BSD-3-Clause
// Free room on a site's floor and ways through it.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "site.h"

namespace headway::sim {

/// Where on a site's floor there is room, and ways through it.
class NavigationGrid {
 public:
  explicit NavigationGrid(const Site& site);

  /// Distance to the nearest obstacle or to the edge of the site [m]; 0 inside of one.
  [[nodiscard]] double clearance(const Eigen::Vector2d& at) const;
  /// Whether a straight line keeps its distance to all obstacles.
  [[nodiscard]] bool isClear(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                             double radius) const;

  /// Corners of a short way that keeps `radius` off all obstacles, ending at `to`.
  ///
  /// @return  without `from`; empty if there is no way
  /// @see     Hart, Nilsson & Raphael 1968 (A*)
  [[nodiscard]] std::vector<Eigen::Vector2d> path(const Eigen::Vector2d& from,
                                                  const Eigen::Vector2d& to, double radius) const;

 private:
  [[nodiscard]] cv::Point cellAt(const Eigen::Vector2d& at) const;
  [[nodiscard]] Eigen::Vector2d middleOf(const cv::Point& cell) const;
  /// Cells of the cheapest way, from the goal back to the start; empty if there is none.
  [[nodiscard]] std::vector<cv::Point> search(const cv::Point& start, const cv::Point& goal,
                                              double radius) const;
  [[nodiscard]] std::vector<Eigen::Vector2d> straightened(
      const std::vector<Eigen::Vector2d>& points, double radius) const;

  Eigen::Vector2d origin_;
  cv::Mat clearance_;  ///< 32-bit, for each cell [m]
};

}  // namespace headway::sim
