#include <headway/core/error.h>
#include <headway/eval/text_table.h>
#include <headway/io/calibration_file.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "grid_truth.h"
#include "outputs.h"

namespace headway::app {
namespace {

namespace fs = std::filesystem;
using mrpt::maps::COccupancyGridMap2D;

constexpr double kObserved = 0.15;  ///< a cell farther than this from 0.5 is free or occupied

struct Options {
  std::string truth;
  std::string estimate;
  ObstacleHeights heights;
  bool quiet = false;
  Outputs outputs;
};

bool parse(Options& options, int argc, const char** argv) {
  program::CommandLine line("headway-eval grid",
                            "Compares the grid of free and occupied cells of a replay with the "
                            "simulated world that it saw.");
  line.option(options.truth, 0, "truth", "NAME.truth",
              "What headway-sim --depth --masks wrote beside the rawlog", true);
  line.option(options.estimate, 0, "estimate", "OUTDIR",
              "Folder of the replay, with map_grid.gridmap.gz and calibration.yaml", true);
  line.option(options.heights.lowest, 0, "lowest-obstacle", "M", "What is lower is not one");
  line.option(options.heights.highest, 0, "highest-obstacle", "M", "What is higher is not one");
  options.outputs.describe(line);
  if (!line.parse(argc, argv)) return false;
  options.quiet = line.quiet();
  options.outputs.requireWritable();
  return true;
}

eval::GridCells readGrid(const fs::path& path) {
  COccupancyGridMap2D grid;
  mrpt::io::CFileGZInputStream file;
  try {
    if (!file.open(path.string())) throw InputError("no such file");
    mrpt::serialization::archiveFrom(file) >> grid;
  } catch (const std::exception&) {
    throw InputError(path.string() + ": is not a grid map; is this the folder of a replay?");
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

eval::TextTable tableOf(const eval::GridError& error) {
  const auto share = [](std::size_t part, std::size_t whole) {
    return whole == 0 ? std::string("-")
                      : eval::fixedText(
                            100.0 * static_cast<double>(part) / static_cast<double>(whole), 2) +
                            " %";
  };
  const auto row = [&](const std::string& name, std::size_t part, std::size_t whole) {
    return std::vector<std::string>{name, std::to_string(part), share(part, whole)};
  };
  return {{"cells", "number", "share"},
          {"observed", std::to_string(error.observed), ""},
          row("of which the truth is known", error.compared, error.observed),
          row("right", error.right, error.compared),
          row("truly occupied", error.occupied, error.compared),
          row("of these found (recall)", error.found, error.occupied),
          row("called occupied, rightly (precision)", error.found, error.found + error.phantoms),
          row("occupied, but truly free", error.phantoms, error.compared),
          row("of these, beside something", error.near_phantoms, error.phantoms),
          row("free, but truly occupied", error.missed, error.compared),
          row("of these, beside something found", error.near_missed, error.missed),
          row("where something moved", error.trodden, error.compared),
          row("ghosts: of these occupied", error.ghosts, error.trodden),
          {"truly occupied, not observed", std::to_string(error.unseen), ""}};
}

}  // namespace

int runGrid(int argc, const char** argv) {
  Options options;
  if (!parse(options, argc, argv)) return program::kDone;
  const fs::path replay(options.estimate);
  const auto estimate = readGrid(replay / "map_grid.gridmap.gz");
  const auto camera = io::readCalibration((replay / "calibration.yaml").string());
  const auto truth = gridTruth(options.truth, camera, estimate, options.heights);
  const auto error = eval::gridError(truth.cells, estimate, truth.trodden);
  if (!options.quiet) eval::writeTable(std::cout, tableOf(error));
  const auto figures = [&] {
    return nlohmann::ordered_json{{"observed", error.observed},
                                  {"compared", error.compared},
                                  {"right_share", error.rightShare().value_or(0.0)},
                                  {"occupied", error.occupied},
                                  {"found", error.found},
                                  {"occupied_recall", error.occupiedRecall().value_or(0.0)},
                                  {"occupied_precision", error.occupiedPrecision().value_or(0.0)},
                                  {"phantoms", error.phantoms},
                                  {"near_phantoms", error.near_phantoms},
                                  {"missed", error.missed},
                                  {"near_missed", error.near_missed},
                                  {"unseen", error.unseen},
                                  {"trodden", error.trodden},
                                  {"ghosts", error.ghosts}};
  };
  options.outputs.write(figures,
                        [&] { return eval::gridPlot(truth.cells, estimate, truth.trodden); });
  return program::kDone;
}

}  // namespace headway::app
