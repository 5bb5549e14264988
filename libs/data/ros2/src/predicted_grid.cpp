// SPDX-License-Identifier: BSD-3-Clause
// Where objects will be, as cells of a grid.
#include "predicted_grid.h"

#include <headway/map/contact_probability.h>

#include <algorithm>
#include <cmath>

namespace headway::ros2 {
namespace {

/// A cell of a grid, by its column and row, and a share of something.
struct CellShare {
  int x = 0, y = 0;
  double share = 0.0;
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
std::vector<CellShare> footprintCells(const map::Obstacle& obstacle, const Eigen::Vector2d& centre,
                                      double cell_m) {
  constexpr int kSamples = 4;  // along each side of a cell
  const auto outline = map::contactRegion({}, 0.0, obstacle.shape, obstacle.yaw);
  const double radius = obstacle.shape.radius();
  const Eigen::Array2i first = ((centre.array() - radius) / cell_m).floor().cast<int>();
  const Eigen::Array2i last = ((centre.array() + radius) / cell_m).floor().cast<int>();
  std::vector<CellShare> cells;
  for (int y = first.y(); y <= last.y(); ++y) {
    for (int x = first.x(); x <= last.x(); ++x) {
      int inside = 0;
      for (int i = 0; i < kSamples * kSamples; ++i) {
        const Eigen::Vector2d sample(x + (i % kSamples + 0.5) / kSamples,
                                     y + (i / kSamples + 0.5) / kSamples);
        if (isInside(outline, cell_m * sample - centre)) ++inside;
      }
      if (inside > 0) cells.push_back({x, y, inside / double{kSamples * kSamples}});
    }
  }
  return cells;
}

/// Probabilities of steps of whole cells, which sum up to 1.
std::vector<CellShare> steps(const Eigen::Matrix2d& covariance, double cell_m) {
  constexpr double kSigmas = 3.0;  // beyond them about a percent is left
  // That of a place within its cell is part of it, so that small ones are more than one sample.
  const Eigen::Matrix2d in_cells =
      covariance / (cell_m * cell_m) + Eigen::Matrix2d::Identity() / 12.0;
  const Eigen::Matrix2d information = in_cells.inverse();
  // What is spread over more than 100 cells counts as if it were within them.
  const Eigen::Array2i reach =
      (kSigmas * in_cells.diagonal().array().sqrt()).ceil().min(100.0).cast<int>();
  std::vector<CellShare> all;
  double sum = 0.0;
  for (int y = -reach.y(); y <= reach.y(); ++y) {
    for (int x = -reach.x(); x <= reach.x(); ++x) {
      const Eigen::Vector2d step(x, y);
      const double squared = step.dot(information * step);
      if (squared > kSigmas * kSigmas) continue;
      all.push_back({x, y, std::exp(-0.5 * squared)});
      sum += all.back().share;
    }
  }
  for (CellShare& step : all) step.share /= sum;
  return all;
}

}  // namespace

void setOccupancy(const std::vector<map::Obstacle>& obstacles, GridMessage& grid) {
  std::vector<double> of_track(grid.cells.size(), 0.0), none(grid.cells.size(), 1.0);
  const auto end_track = [&] {
    for (std::size_t i = 0; i < none.size(); ++i) {
      none[i] *= 1.0 - std::min(of_track[i], 1.0);
      of_track[i] = 0.0;
    }
  };
  const auto width = static_cast<int>(grid.width), height = static_cast<int>(grid.height);
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    const map::Obstacle& obstacle = obstacles[k];
    if (k > 0 && !(obstacles[k - 1].id == obstacle.id)) end_track();
    const auto footprint = footprintCells(obstacle, obstacle.centre - grid.corner, grid.cell_m);
    for (const CellShare& step : steps(obstacle.covariance, grid.cell_m)) {
      for (const CellShare& cell : footprint) {
        const int x = cell.x + step.x, y = cell.y + step.y;
        if (x < 0 || x >= width || y < 0 || y >= height) continue;
        of_track[static_cast<std::size_t>(y * width + x)] +=
            obstacle.probability * step.share * cell.share;
      }
    }
  }
  end_track();
  for (std::size_t i = 0; i < none.size(); ++i) {
    grid.cells[i] = static_cast<std::int8_t>(std::lround(100.0 * (1.0 - none[i])));
  }
}

}  // namespace headway::ros2
