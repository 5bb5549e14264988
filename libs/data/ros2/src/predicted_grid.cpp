// SPDX-License-Identifier: BSD-3-Clause
// Where objects will be, as cells of a grid.
#include "predicted_grid.h"

#include <headway/map/contact_probability.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace headway::ros2 {
namespace {

/// Covered ratio of each cell, from a column and row on.
struct CellRatios {
  cv::Point corner;
  cv::Mat1f ratios;
};

bool isInside(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& place) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d along = polygon[(i + 1) % polygon.size()] - polygon[i];
    const Eigen::Vector2d to = place - polygon[i];
    if (along.x() * to.y() - along.y() * to.x() < 0.0) return false;
  }
  return true;
}

/// How much of each cell an object at a place covers.
CellRatios footprintCells(const map::Obstacle& obstacle, const Eigen::Vector2d& centre,
                          double cell_m) {
  constexpr int kSamples = 4;  // along each side of a cell
  const auto outline = map::contactRegion({}, 0.0, obstacle.shape, obstacle.yaw);
  const double radius = obstacle.shape.radius();
  const Eigen::Array2i first = ((centre.array() - radius) / cell_m).floor().cast<int>();
  const Eigen::Array2i last = ((centre.array() + radius) / cell_m).floor().cast<int>();
  const Eigen::Array2i size = last - first + 1;
  CellRatios cells{{first.x(), first.y()}, cv::Mat1f(size.y(), size.x())};
  for (int y = 0; y < size.y(); ++y) {
    for (int x = 0; x < size.x(); ++x) {
      int inside = 0;
      for (int i = 0; i < kSamples * kSamples; ++i) {
        const Eigen::Vector2d sample(first.x() + x + (i % kSamples + 0.5) / kSamples,
                                     first.y() + y + (i / kSamples + 0.5) / kSamples);
        if (isInside(outline, cell_m * sample - centre)) ++inside;
      }
      cells.ratios(y, x) = static_cast<float>(inside) / (kSamples * kSamples);
    }
  }
  return cells;
}

/// Probabilities of steps of whole cells, which sum up to 1; that of none is in the middle.
cv::Mat1f steps(const Eigen::Matrix2d& covariance, double cell_m) {
  constexpr double kSigmas = 3.0;  // beyond them about a percent is left
  // That of a place within its cell is part of it, so that small ones are more than one sample.
  const Eigen::Matrix2d in_cells =
      covariance / (cell_m * cell_m) + Eigen::Matrix2d::Identity() / 12.0;
  const Eigen::Matrix2d information = in_cells.inverse();
  // What is spread over more than 100 cells counts as if it were within them.
  const Eigen::Array2i reach =
      (kSigmas * in_cells.diagonal().array().sqrt()).ceil().min(100.0).cast<int>();
  cv::Mat1f all(2 * reach.y() + 1, 2 * reach.x() + 1);
  for (int y = 0; y < all.rows; ++y) {
    for (int x = 0; x < all.cols; ++x) {
      const Eigen::Vector2d step(x - reach.x(), y - reach.y());
      const double squared = step.dot(information * step);
      all(y, x) = squared > kSigmas * kSigmas ? 0.0F : static_cast<float>(std::exp(-0.5 * squared));
    }
  }
  all /= cv::sum(all)[0];
  return all;
}

/// The probability that each cell is covered, `footprint` and what the steps reach around it.
cv::Mat1f covered(const cv::Mat1f& footprint, const cv::Mat1f& steps) {
  const int x = steps.cols / 2, y = steps.rows / 2;
  cv::Mat1f within, all;
  cv::copyMakeBorder(footprint, within, y, y, x, x, cv::BORDER_CONSTANT, 0.0);
  cv::filter2D(within, all, CV_32F, steps, {-1, -1}, 0.0, cv::BORDER_CONSTANT);
  return all;
}

}  // namespace

void setOccupancy(const std::vector<map::Obstacle>& obstacles, GridMessage& grid) {
  const cv::Size size(static_cast<int>(grid.width), static_cast<int>(grid.height));
  cv::Mat1f of_track(size, 0.0F), none(size, 1.0F);
  const auto end_track = [&] {
    none = none.mul(1.0F - cv::min(of_track, 1.0F));
    of_track.setTo(0.0F);
  };
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    const map::Obstacle& obstacle = obstacles[k];
    if (k > 0 && !(obstacles[k - 1].id == obstacle.id)) end_track();
    const auto footprint = footprintCells(obstacle, obstacle.centre - grid.corner, grid.cell_m);
    const cv::Mat1f kernel = steps(obstacle.covariance, grid.cell_m);
    const cv::Rect reached(footprint.corner - cv::Point(kernel.cols / 2, kernel.rows / 2),
                           footprint.ratios.size() + kernel.size() - cv::Size(1, 1));
    const cv::Rect inside = reached & cv::Rect({0, 0}, size);
    if (inside.empty()) continue;
    of_track(inside) +=
        obstacle.probability * covered(footprint.ratios, kernel)(inside - reached.tl());
  }
  end_track();
  std::transform(none.begin(), none.end(), grid.cells.begin(), [](float probability) {
    return static_cast<std::int8_t>(std::lround(100.0F * (1.0F - probability)));
  });
}

}  // namespace headway::ros2
