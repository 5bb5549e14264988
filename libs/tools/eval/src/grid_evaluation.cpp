// SPDX-License-Identifier: BSD-3-Clause
// Evaluation of the occupancy grid of a replay's folder.
#include <headway/core/error.h>
#include <headway/core/stereo_camera.h>
#include <headway/eval/figures.h>
#include <headway/eval/grid_error.h>
#include <headway/eval/labelled_frames.h>
#include <headway/io/calibration_file.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "evaluation_inputs.h"

namespace headway::eval {
namespace {

/// True state of the cells of a grid.
struct GridTruth {
  GridCells cells;
  std::vector<std::uint8_t> swept;     ///< 1: a moving object covered the cell at some time
  std::vector<std::uint8_t> people;    ///< 1: somebody stood or sat there at some time
  std::vector<std::uint8_t> in_reach;  ///< 1: an obstacle in the cell was visible within the reach
  std::vector<std::uint8_t> ahead;     ///< 1: it was visible at a depth of 0.5 to 3 m
  std::vector<std::uint8_t> low;       ///< 1: an obstacle that may be called one, or not
  std::vector<std::uint8_t> drops;     ///< 1: the floor is lower than the ground by min_m or
                                       ///< more, or the cell lies in an outline of drops.csv
};

namespace fs = std::filesystem;

/// From which pixels the truth of a cell is taken.
struct PixelRules {
  double reach_m = 40.0;          ///< beyond this range a pixel covers more than a cell
  double ground_m = 0.15;         ///< maximum height of ground and kerbs
  double height_margin_m = 0.01;  ///< surfaces this close to the asked height are undecided
  double ahead_from_m = 0.5, ahead_to_m = 3.0;
  int min_pixels = 2;           ///< over all frames; rejects mixed pixels at depth edges
  int visible_pixels = 49;      ///< of an obstacle in one frame: a quarter of a matched block
  double swept_margin_m = 0.2;  ///< around the box of a moving object
};
constexpr PixelRules kRules{};

/// Number of pixels on the ground and on obstacles in each cell.
struct PixelCounts {
  explicit PixelCounts(std::size_t cells)
      : ground(cells, 0),
        low(cells, 0),
        obstacle(cells, 0),
        in_reach(cells, 0),
        ahead(cells, 0),
        drop(cells, 0) {}
  std::vector<int> ground;
  std::vector<int> low;  ///< between low_m and min_m
  std::vector<int> obstacle;
  std::vector<int> in_reach;  ///< of the obstacle, most in one frame
  std::vector<int> ahead;     ///< of the obstacle, most in one frame
  std::vector<int> drop;
};

void countPixels(const cv::Mat& depth, const cv::Mat& moving, const StereoCamera& camera,
                 const Pose& T_map_robot, const GridCells& grid, const ObstacleHeights& heights,
                 const ObstacleReach& reach, PixelCounts& counts) {
  const double ground = std::min(kRules.ground_m, heights.low_m - kRules.height_margin_m);
  std::unordered_map<std::size_t, int> in_reach;
  std::unordered_map<std::size_t, int> ahead;
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      const auto z = static_cast<double>(depth.at<float>(v, u));
      if (z <= 0.0 || z > kRules.reach_m || moving.at<std::uint8_t>(v, u) != 0) continue;
      const Eigen::Vector3d in_robot =
          camera.T_robot_cam * (z * ray(Eigen::Vector2d(u, v), camera));
      const Eigen::Vector3d in_map = T_map_robot * in_robot;
      const auto cell = grid.at(in_map.head<2>());
      if (!cell) continue;
      // Simulated ground is level, while the robot pitches and rolls: heights are taken in the map.
      const double height = in_map.z() - T_map_robot.translation().z();
      if (height <= -heights.min_m) ++counts.drop[*cell];
      if (height < ground && height > -heights.min_m) ++counts.ground[*cell];
      if (height < heights.low_m + kRules.height_margin_m || height > heights.max_m) continue;
      if (height < heights.min_m + kRules.height_margin_m) {
        ++counts.low[*cell];
        continue;
      }
      ++counts.obstacle[*cell];
      const double hidden = camera.isDepthCamera() ? 0.0 : camera.fx * camera.baseline_m / z;
      if (u < hidden) continue;  // outside of the right image
      if (z >= reach.from_m && z <= reach.to_m) ++in_reach[*cell];
      if (z >= kRules.ahead_from_m && z <= kRules.ahead_to_m) ++ahead[*cell];
    }
  }
  for (const auto& [cell, n] : in_reach) counts.in_reach[cell] = std::max(counts.in_reach[cell], n);
  for (const auto& [cell, n] : ahead) counts.ahead[cell] = std::max(counts.ahead[cell], n);
}

/// Marks the cells covered by the box of a moving object.
void markSwept(const Track& object, const GridCells& grid, std::vector<std::uint8_t>& swept) {
  const double along = 0.5 * object.size.x() + kRules.swept_margin_m;
  const double across = 0.5 * object.size.y() + kRules.swept_margin_m;
  const Eigen::Vector2d front(std::cos(object.yaw), std::sin(object.yaw));
  const Eigen::Vector2d left(-front.y(), front.x());
  const double step = 0.5 * grid.resolution_m;
  for (double a = -along; a <= along; a += step) {
    for (double b = -across; b <= across; b += step) {
      const auto cell = grid.at(object.position.head<2>() + a * front + b * left);
      if (cell) swept[*cell] = 1;
    }
  }
}

/// Outlines of drops.csv, by number; empty if there is no such file.
std::map<int, std::vector<Eigen::Vector2d>> readDrops(const fs::path& path) {
  std::map<int, std::vector<Eigen::Vector2d>> outlines;
  std::ifstream file(path);
  std::string row;
  std::getline(file, row);  // header
  for (int line = 2; std::getline(file, row); ++line) {
    int drop = 0;
    double x = 0.0, y = 0.0;
    if (std::sscanf(row.c_str(), "%d,%lf,%lf", &drop, &x, &y) != 3) {
      throw InputError(path.string() + ":" + std::to_string(line) + ": is not drop,x,y,depth_m");
    }
    outlines[drop].emplace_back(x, y);
  }
  return outlines;
}

/// Whether a point lies to the left of all edges of a counterclockwise outline.
bool isInside(const Eigen::Vector2d& point, const std::vector<Eigen::Vector2d>& outline) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d edge = outline[(i + 1) % outline.size()] - outline[i];
    const Eigen::Vector2d to = point - outline[i];
    if (edge.x() * to.y() - edge.y() * to.x() < 0.0) return false;
  }
  return true;
}

/// Marks the cells that lie in a drop with all four corners.
void markDrops(const fs::path& path, const GridCells& grid, std::vector<std::uint8_t>& drops) {
  for (const auto& [number, outline] : readDrops(path)) {
    for (std::size_t i = 0; i < drops.size(); ++i) {
      const auto columns = static_cast<std::size_t>(grid.columns);
      bool whole = true;
      for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
        const Eigen::Vector2d corner(static_cast<double>(i % columns) + x,
                                     static_cast<double>(i / columns) + y);
        whole = whole && isInside(grid.origin + grid.resolution_m * corner, outline);
      }
      if (whole) drops[i] = 1;
    }
  }
}

/// Computes the true occupancy from the truth folder of a simulated rawlog: true depth images,
/// masks of moving objects and true poses. A cell is occupied if a static surface at an obstacle's
/// height is visible in it, free if only ground is, unknown if a surface is that may be called an
/// obstacle, or not, or one within 1 cm of those heights, and no higher one. An obstacle counts as
/// visible where both cameras see it, with 49 pixels in one frame of the left one: a quarter of a
/// block that is matched.
///
/// @param folder  NAME.truth with depth/, masks/, trajectory.tum, objects.csv and, if there are
///                drops, drops.csv
/// @param camera  camera of the depth images, mounted on the robot
/// @param grid    defines the cells; its states are not used
/// @throws InputError if a file is missing or its size differs from the camera's
GridTruth gridTruth(const fs::path& folder, const StereoCamera& camera, const GridCells& grid,
                    const ObstacleHeights& heights, const ObstacleReach& reach) {
  const std::vector<std::uint8_t> none(grid.states.size(), 0);
  GridTruth truth{grid, none, none, none, none, none, none};
  const auto poses = io::readTum((folder / "trajectory.tum").string());
  PixelCounts counts(grid.states.size());
  for (std::size_t frame = 0; frame < poses.size(); ++frame) {
    const cv::Mat moving = readMovingMask(folder, frame, camera);
    countPixels(readTrueDepth(folder, frame, camera), moving, camera, poses[frame].value, grid,
                heights, reach, counts);
  }
  for (std::size_t i = 0; i < grid.states.size(); ++i) {
    const bool is_occupied = counts.obstacle[i] >= kRules.min_pixels;
    truth.low[i] = !is_occupied && counts.low[i] >= kRules.min_pixels;
    const bool is_free = truth.low[i] == 0 && counts.ground[i] >= kRules.min_pixels;
    truth.cells.states[i] = is_occupied ? CellState::kOccupied
                            : is_free   ? CellState::kFree
                                        : CellState::kUnknown;
    truth.in_reach[i] = counts.in_reach[i] >= kRules.visible_pixels;
    truth.ahead[i] = counts.ahead[i] >= kRules.visible_pixels;
    // A pit's wall is no obstacle of its own; what reaches above the ground is.
    truth.drops[i] = counts.drop[i] >= kRules.min_pixels && counts.obstacle[i] < kRules.min_pixels;
  }
  markDrops(folder / "drops.csv", grid, truth.drops);
  for (const auto& sample : io::readTrackCsv((folder / "objects.csv").string())) {
    if (isMoving(sample.track)) {
      markSwept(sample.track, grid, truth.swept);
    } else if (isPerson(sample.track.object_class)) {
      markSwept(sample.track, grid, truth.people);
    }
  }
  return truth;
}

using mrpt::maps::COccupancyGridMap2D;

constexpr double kObserved = 0.15;  ///< minimum |p(free) - 0.5| of an observed cell

GridCells readGrid(const fs::path& path) {
  COccupancyGridMap2D grid;
  mrpt::io::CFileGZInputStream file;
  try {
    if (!file.open(path.string())) throw InputError("no such file");
    mrpt::serialization::archiveFrom(file) >> grid;
  } catch (const std::exception&) {
    throw InputError(path.string() +
                     ": is not a readable occupancy grid; is this the output folder of a replay?");
  }
  GridCells cells({grid.getXMin(), grid.getYMin()}, grid.getResolution(),
                  static_cast<int>(grid.getSizeX()), static_cast<int>(grid.getSizeY()));
  for (int row = 0; row < cells.rows; ++row) {
    for (int column = 0; column < cells.columns; ++column) {
      const double free = static_cast<double>(grid.getCell(column, row)) - 0.5;
      if (std::abs(free) < kObserved) continue;
      cells.states[static_cast<std::size_t>(row * cells.columns + column)] =
          free > 0.0 ? CellState::kFree : CellState::kOccupied;
    }
  }
  return cells;
}

/// What a replay was asked to see, as its replay.json says.
struct Claim {
  ObstacleHeights heights;
  ObstacleReach reach;
};

Claim claimOf(const fs::path& path) {
  Claim claim;
  std::ifstream file(path);
  if (!file) return claim;  // a grid without its replay is judged by a car's heights
  try {
    const auto json = nlohmann::json::parse(file);
    const auto& configuration = json.at("configuration");
    claim.heights.max_m =
        std::stod(configuration.at("grid").at("max_obstacle_height_m").get<std::string>());
    if (const auto rig = json.find("rig"); rig != json.end() && rig->is_object()) {
      claim.heights.min_m = rig->at("min_obstacle_height_m");
      claim.heights.low_m = rig->value("low_obstacle_height_m", claim.heights.min_m);
      claim.reach = {rig->at("obstacles_from_m"), rig->at("obstacles_to_m")};
    }
  } catch (const std::exception& error) {
    throw InputError(path.string() + ": is not the record of a replay: " + error.what());
  }
  return claim;
}

/// A map's truth has no people and nothing that moves; a rim of a drop is an obstacle, and so is
/// what may be called one; what lies deeper in a drop is neither obstacle nor free.
OccupiedPrecision precisionOf(const GridTruth& truth, const GridCells& estimate) {
  GridCells cells = truth.cells;
  std::vector<std::uint8_t> left_out = truth.swept;
  const auto rims = rimsOf(cells, truth.drops);
  for (std::size_t i = 0; i < left_out.size(); ++i) {
    if (rims[i] != 0 || truth.low[i] != 0) cells.states[i] = CellState::kOccupied;
    if (truth.people[i] != 0 || (truth.drops[i] != 0 && rims[i] == 0)) left_out[i] = 1;
  }
  return occupiedPrecision(cells, estimate, left_out);
}

nlohmann::ordered_json visibleJson(const VisibleObstacles& visible) {
  return {{"occupied", visible.occupied},
          {"judged_ratio", visible.judgedRatio().value_or(0.0)},
          {"found_ratio", visible.foundRatio().value_or(0.0)},
          {"free_alone_ratio", visible.freeAloneRatio().value_or(0.0)}};
}

}  // namespace

GridEvaluation evaluateGrid(const fs::path& truth, const fs::path& replay,
                            const ObstacleHeights& heights) {
  GridEvaluation result;
  result.estimate = readGrid(replay / "map_grid.gridmap.gz");
  const auto camera = io::readCalibration((replay / "calibration.yaml").string());
  const Claim claim = claimOf(replay / "replay.json");
  result.heights.min_m = heights.min_m > 0.0 ? heights.min_m : claim.heights.min_m;
  result.heights.low_m = heights.min_m > 0.0 ? heights.min_m : claim.heights.low_m;
  result.heights.max_m = heights.max_m > 0.0 ? heights.max_m : claim.heights.max_m;
  result.reach = claim.reach;
  auto cells = gridTruth(truth, camera, result.estimate, result.heights, claim.reach);
  result.in_reach = visibleObstacles(cells.cells, result.estimate, cells.in_reach);
  result.ahead = visibleObstacles(cells.cells, result.estimate, cells.ahead);
  result.drops = static_cast<std::size_t>(std::count(cells.drops.begin(), cells.drops.end(), 1));
  result.drops_free = markedFree(result.estimate, cells.drops);
  result.error = gridError(cells.cells, result.estimate, cells.swept);
  result.precision = precisionOf(cells, result.estimate);
  result.truth = std::move(cells.cells);
  result.swept = std::move(cells.swept);
  return result;
}

nlohmann::ordered_json toJson(const GridEvaluation& evaluation) {
  const auto& error = evaluation.error;
  const auto& precision = evaluation.precision;
  return {{"observed", error.observed},
          {"compared", error.compared},
          {"right_ratio", error.correctRatio().value_or(0.0)},
          {"occupied", error.occupied},
          {"found", error.found},
          {"occupied_recall", error.occupiedRecall().value_or(0.0)},
          {"occupied_precision", error.occupiedPrecision().value_or(0.0)},
          {"phantoms", error.false_occupied},
          {"near_phantoms", error.near_false_occupied},
          {"missed", error.false_free},
          {"near_missed", error.near_false_free},
          {"unseen", error.unseen},
          {"trodden", error.swept},
          {"ghosts", error.ghosts},
          {"ghost_ratio", orNull(error.ghostRatio())},
          {"touch",
           {{"called_occupied", precision.called},
            {"precision", orNull(precision.touchRatio())},
            {"strict_precision", orNull(precision.strictRatio())},
            {"right", precision.touching},
            {"strictly_right", precision.strict},
            {"phantoms", precision.phantoms()},
            {"unknown", precision.unknown},
            {"left_out", precision.left_out}}},
          {"min_obstacle_height_m", evaluation.heights.min_m},
          {"low_obstacle_height_m", evaluation.heights.low_m},
          {"reach_m", evaluation.reach.to_m},
          {"in_reach", visibleJson(evaluation.in_reach)},
          {"ahead", visibleJson(evaluation.ahead)},
          {"drops", evaluation.drops},
          {"drops_free", evaluation.drops_free}};
}

}  // namespace headway::eval
