// SPDX-License-Identifier: BSD-3-Clause
// Predicted grids against the exact probability that an object covers a place.
#include "predicted_grid.h"

#include <gtest/gtest.h>
#include <headway/map/contact_probability.h>

#include <algorithm>
#include <cmath>

namespace headway::ros2 {
namespace {

map::Obstacle obstacleAt(const Eigen::Vector2d& centre, double sigma_m) {
  map::Obstacle obstacle;
  obstacle.centre = centre;
  obstacle.covariance = Eigen::Vector2d(sigma_m * sigma_m, 0.25 * sigma_m * sigma_m).asDiagonal();
  obstacle.covariance(0, 1) = obstacle.covariance(1, 0) = 0.2 * sigma_m * sigma_m;
  return obstacle;
}

GridMessage emptyGrid() {
  GridMessage grid;
  grid.cell_m = 0.2;
  grid.corner = {-5.0, -5.0};
  grid.width = grid.height = 50;
  grid.cells.assign(2500, 0);
  return grid;
}

/// The greatest difference of a cell from the mean of the exact probability in it.
double greatestError(const map::Obstacle& obstacle) {
  auto grid = emptyGrid();
  setOccupancy({obstacle}, grid);
  const auto region = map::contactRegion({}, 0.0, obstacle.shape, obstacle.yaw);
  double greatest = 0.0;
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    double exact = 0.0;
    for (const double dx : {0.05, 0.15}) {
      for (const double dy : {0.05, 0.15}) {
        const Eigen::Vector2d place =
            grid.corner + Eigen::Vector2d(0.2 * static_cast<double>(i % 50) + dx,
                                          0.2 * static_cast<double>(i / 50) + dy);
        exact +=
            0.25 * map::probabilityInside(region, obstacle.centre - place, obstacle.covariance);
      }
    }
    greatest = std::max(greatest, std::abs(0.01 * grid.cells[i] - obstacle.probability * exact));
  }
  return greatest;
}

TEST(PredictedGridTest, CellsHaveTheProbabilityThatTheyAreCovered) {
  for (const double sigma_m : {0.1, 0.4, 1.2}) {
    auto person = obstacleAt({0.33, -0.71}, sigma_m);
    person.shape = {0.6, 0.5, true};
    person.probability = 0.8;
    EXPECT_LT(greatestError(person), 0.06) << sigma_m;
    auto car = obstacleAt({-1.07, 0.4}, sigma_m);
    car.shape = {4.2, 1.8, false};
    car.yaw = 0.6;
    EXPECT_LT(greatestError(car), 0.06) << sigma_m;
  }
}

TEST(PredictedGridTest, PredictionsOfOneTrackAddUpAndTracksAreIndependent) {
  auto left = obstacleAt({0.1, 0.1}, 0.02);
  left.shape = {1.0, 1.0, false};
  left.id = TrackId{1};
  left.probability = 0.5;
  const std::size_t cell = 25 * 50 + 25;
  for (const auto& [id, percent] : {std::pair(1, 100), std::pair(2, 75)}) {
    auto right = left;
    right.id = TrackId{id};
    auto grid = emptyGrid();
    setOccupancy({left, right}, grid);
    EXPECT_EQ(percent, grid.cells[cell]);
  }
}

TEST(PredictedGridTest, WhatIsOutsideOrAnywhereLeavesTheGridWhole) {
  auto grid = emptyGrid();
  auto far = obstacleAt({200.0, -300.0}, 0.5);
  far.shape = {1.0, 1.0, false};
  auto anywhere = obstacleAt({0.0, 0.0}, 1e4);
  anywhere.shape = {1.0, 1.0, false};
  setOccupancy({far, anywhere}, grid);
  EXPECT_LT(*std::max_element(grid.cells.begin(), grid.cells.end()), 2);
}

}  // namespace
}  // namespace headway::ros2
