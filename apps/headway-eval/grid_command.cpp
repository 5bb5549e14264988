// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/eval/plots.h>
#include <headway/io/calibration_file.h>
#include <headway/plot/text_table.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "grid_truth.h"

namespace headway::app {
namespace {

namespace fs = std::filesystem;
using mrpt::maps::COccupancyGridMap2D;

constexpr double kObserved = 0.15;  ///< minimum |p(free) - 0.5| of an observed cell

struct GridOptions {
  std::string truth;
  std::string estimate;
  ObstacleHeights heights{0.0, 0.0};  ///< 0: as in the replay
  bool quiet = false;
  Outputs outputs;
};

bool parseGrid(GridOptions& options, int argc, const char** argv) {
  program::CommandLine line(
      "headway-eval grid",
      "Compares the occupancy grid of a replay with the simulated world it was "
      "recorded in.");
  line.option(options.truth, 0, "truth", "NAME.truth",
              "Truth folder written by headway-sim --depth --masks", true);
  line.option(options.estimate, 0, "estimate", "OUTDIR",
              "Folder of the replay, with map_grid.gridmap.gz and calibration.yaml", true);
  line.option(options.heights.min_m, 0, "lowest-obstacle", "M",
              "Minimum height of an obstacle [m]; default: that of the replay");
  line.option(options.heights.max_m, 0, "highest-obstacle", "M",
              "Maximum height of an obstacle above the ground [m]; default: that of the replay");
  options.outputs.describe(line);
  if (!line.parse(argc, argv)) return false;
  options.quiet = line.quiet();
  options.outputs.requireWritable({options.truth, options.estimate});
  return true;
}

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

/// Obstacles and drops by where they were visible.
struct Visible {
  eval::VisibleObstacles in_reach;
  eval::VisibleObstacles ahead;
  std::size_t drops = 0;
  std::size_t drops_free = 0;
};

Visible visibleOf(const GridTruth& truth, const eval::GridCells& estimate) {
  return {eval::visibleObstacles(truth.cells, estimate, truth.in_reach),
          eval::visibleObstacles(truth.cells, estimate, truth.ahead),
          static_cast<std::size_t>(std::count(truth.drops.begin(), truth.drops.end(), 1)),
          eval::markedFree(estimate, truth.drops)};
}

nlohmann::ordered_json visibleJson(const eval::VisibleObstacles& visible) {
  return {{"occupied", visible.occupied},
          {"judged_ratio", visible.judgedRatio().value_or(0.0)},
          {"found_ratio", visible.foundRatio().value_or(0.0)},
          {"free_alone_ratio", visible.freeAloneRatio().value_or(0.0)}};
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

plot::TextTable tableOf(const eval::GridError& error, const Visible& visible) {
  const auto ratio = [](std::size_t part, std::size_t whole) {
    return whole == 0 ? std::string("-")
                      : plot::fixedText(
                            100.0 * static_cast<double>(part) / static_cast<double>(whole), 2) +
                            " %";
  };
  const auto row = [&](const std::string& name, std::size_t part, std::size_t whole) {
    return std::vector<std::string>{name, std::to_string(part), ratio(part, whole)};
  };
  return {{"cells", "number", "ratio"},
          {"observed", std::to_string(error.observed), ""},
          row("with known truth", error.compared, error.observed),
          row("correct", error.correct, error.compared),
          row("truly occupied", error.occupied, error.compared),
          row("of these, estimated as occupied (recall)", error.found, error.occupied),
          row("estimated as occupied, correct (precision)", error.found,
              error.found + error.false_occupied),
          row("estimated as occupied, truly free", error.false_occupied, error.compared),
          row("of these, next to a true obstacle", error.near_false_occupied, error.false_occupied),
          row("estimated as free, truly occupied", error.false_free, error.compared),
          row("of these, next to a found obstacle", error.near_false_free, error.false_free),
          row("covered by a moving object at some time", error.swept, error.compared),
          row("of these, estimated as occupied (ghosts)", error.ghosts, error.swept),
          {"truly occupied, not observed", std::to_string(error.unseen), ""},
          {"truly occupied, visible within the rig's reach",
           std::to_string(visible.in_reach.occupied), ""},
          row("of these, observed", visible.in_reach.judged, visible.in_reach.occupied),
          row("of the observed, estimated as occupied", visible.in_reach.found,
              visible.in_reach.judged),
          row("of the observed, estimated as free with nothing beside", visible.in_reach.free_alone,
              visible.in_reach.judged),
          {"truly occupied, visible at 0.5 to 3 m", std::to_string(visible.ahead.occupied), ""},
          row("of these, observed", visible.ahead.judged, visible.ahead.occupied),
          row("of the observed, estimated as occupied", visible.ahead.found, visible.ahead.judged),
          row("drops, estimated as free", visible.drops_free, visible.drops)};
}

}  // namespace

int runGrid(int argc, const char** argv) {
  GridOptions options;
  if (!parseGrid(options, argc, argv)) return program::kDone;
  const fs::path replay(options.estimate);
  const auto estimate = readGrid(replay / "map_grid.gridmap.gz");
  const auto camera = io::readCalibration((replay / "calibration.yaml").string());
  const Claim claim = claimOf(replay / "replay.json");
  if (options.heights.min_m <= 0.0) options.heights.min_m = claim.heights.min_m;
  if (options.heights.max_m <= 0.0) options.heights.max_m = claim.heights.max_m;
  const auto truth = gridTruth(options.truth, camera, estimate, options.heights, claim.reach);
  const Visible visible = visibleOf(truth, estimate);
  const auto error = eval::gridError(truth.cells, estimate, truth.swept);
  if (!options.quiet) plot::writeTable(std::cout, tableOf(error, visible));
  const auto figures = [&] {
    return nlohmann::ordered_json{{"observed", error.observed},
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
                                  {"min_obstacle_height_m", options.heights.min_m},
                                  {"reach_m", claim.reach.to_m},
                                  {"in_reach", visibleJson(visible.in_reach)},
                                  {"ahead", visibleJson(visible.ahead)},
                                  {"drops", visible.drops},
                                  {"drops_free", visible.drops_free}};
  };
  options.outputs.write(figures,
                        [&] { return eval::gridPlot(truth.cells, estimate, truth.swept); });
  return program::kDone;
}

}  // namespace headway::app
