// SPDX-License-Identifier: BSD-3-Clause
#include <headway/eval/grid_error.h>
#include <headway/eval/plots.h>
#include <headway/plot/text_table.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"

namespace headway::app {
namespace {

using eval::GridEvaluation;

struct GridOptions {
  std::string truth;
  std::string estimate;
  eval::ObstacleHeights heights{0.0, 0.0};  ///< 0: as in the replay
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

plot::TextTable tableOf(const GridEvaluation& evaluation) {
  const auto& error = evaluation.error;
  const auto& precision = evaluation.precision;
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
          row("obstacles or touching one, of those called occupied (precision with touch)",
              precision.touching, precision.called),
          row("obstacles, of those called occupied (strict precision)", precision.strict,
              precision.called),
          row("phantoms: called occupied with no obstacle beside", precision.phantoms(),
              precision.called),
          {"called occupied, truth unknown: left out", std::to_string(precision.unknown), ""},
          {"called occupied where people or movers were: left out",
           std::to_string(precision.left_out), ""},
          row("estimated as occupied, truly free", error.false_occupied, error.compared),
          row("of these, next to a true obstacle", error.near_false_occupied, error.false_occupied),
          row("estimated as free, truly occupied", error.false_free, error.compared),
          row("of these, next to a found obstacle", error.near_false_free, error.false_free),
          row("covered by a moving object at some time", error.swept, error.compared),
          row("of these, estimated as occupied (ghosts)", error.ghosts, error.swept),
          {"truly occupied, not observed", std::to_string(error.unseen), ""},
          {"truly occupied, visible within the rig's reach",
           std::to_string(evaluation.in_reach.occupied), ""},
          row("of these, observed", evaluation.in_reach.judged, evaluation.in_reach.occupied),
          row("of the observed, estimated as occupied", evaluation.in_reach.found,
              evaluation.in_reach.judged),
          row("of the observed, estimated as free with nothing beside",
              evaluation.in_reach.free_alone, evaluation.in_reach.judged),
          {"truly occupied, visible at 0.5 to 3 m", std::to_string(evaluation.ahead.occupied), ""},
          row("of these, observed", evaluation.ahead.judged, evaluation.ahead.occupied),
          row("of the observed, estimated as occupied", evaluation.ahead.found,
              evaluation.ahead.judged),
          row("drops, estimated as free", evaluation.drops_free, evaluation.drops)};
}

}  // namespace

int runGrid(int argc, const char** argv) {
  GridOptions options;
  if (!parseGrid(options, argc, argv)) return program::kDone;
  const auto result = eval::evaluateGrid(options.truth, options.estimate, options.heights);
  if (!options.quiet) plot::writeTable(std::cout, tableOf(result));
  options.outputs.write(
      [&] { return toJson(result); },
      [&] { return eval::gridPlot(result.truth, result.estimate, result.swept); });
  return program::kDone;
}

}  // namespace headway::app
