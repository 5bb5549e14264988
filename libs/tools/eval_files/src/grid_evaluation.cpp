// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/eval_files/grid_evaluation.h>
#include <headway/io/calibration_file.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "grid_truth.h"

namespace headway::eval_files {
namespace {

namespace fs = std::filesystem;
using mrpt::maps::COccupancyGridMap2D;

constexpr double kObserved = 0.15;  ///< minimum |p(free) - 0.5| of an observed cell

eval::GridCells readGrid(const fs::path& path) {
  COccupancyGridMap2D grid;
  mrpt::io::CFileGZInputStream file;
  try {
    if (!file.open(path.string())) throw InputError("no such file");
    mrpt::serialization::archiveFrom(file) >> grid;
  } catch (const std::exception&) {
    throw InputError(path.string() +
                     ": is not a readable occupancy grid; is this the output folder of a replay?");
  }
  eval::GridCells cells({grid.getXMin(), grid.getYMin()}, grid.getResolution(),
                        static_cast<int>(grid.getSizeX()), static_cast<int>(grid.getSizeY()));
  for (int row = 0; row < cells.rows; ++row) {
    for (int column = 0; column < cells.columns; ++column) {
      const double free = static_cast<double>(grid.getCell(column, row)) - 0.5;
      if (std::abs(free) < kObserved) continue;
      cells.states[static_cast<std::size_t>(row * cells.columns + column)] =
          free > 0.0 ? eval::CellState::kFree : eval::CellState::kOccupied;
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
      claim.reach = {rig->at("obstacles_from_m"), rig->at("obstacles_to_m")};
    }
  } catch (const std::exception& error) {
    throw InputError(path.string() + ": is not the record of a replay: " + error.what());
  }
  return claim;
}

nlohmann::ordered_json visibleJson(const eval::VisibleObstacles& visible) {
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
  result.heights.max_m = heights.max_m > 0.0 ? heights.max_m : claim.heights.max_m;
  result.reach = claim.reach;
  auto cells = gridTruth(truth, camera, result.estimate, result.heights, claim.reach);
  result.in_reach = eval::visibleObstacles(cells.cells, result.estimate, cells.in_reach);
  result.ahead = eval::visibleObstacles(cells.cells, result.estimate, cells.ahead);
  result.drops = static_cast<std::size_t>(std::count(cells.drops.begin(), cells.drops.end(), 1));
  result.drops_free = eval::markedFree(result.estimate, cells.drops);
  result.error = eval::gridError(cells.cells, result.estimate, cells.swept);
  result.truth = std::move(cells.cells);
  result.swept = std::move(cells.swept);
  return result;
}

nlohmann::ordered_json toJson(const GridEvaluation& evaluation) {
  const auto& error = evaluation.error;
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
          {"min_obstacle_height_m", evaluation.heights.min_m},
          {"reach_m", evaluation.reach.to_m},
          {"in_reach", visibleJson(evaluation.in_reach)},
          {"ahead", visibleJson(evaluation.ahead)},
          {"drops", evaluation.drops},
          {"drops_free", evaluation.drops_free}};
}

}  // namespace headway::eval_files
