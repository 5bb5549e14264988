// SPDX-License-Identifier: BSD-3-Clause
// headway-eval grid and dense: maps of a replay against the simulated world.
#include <headway/eval/dense_error.h>
#include <headway/eval/grid_error.h>
#include <headway/eval/plots.h>
#include <headway/plot/text_table.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"

namespace headway::app {
namespace {

using eval::DenseEvaluation;
using eval::GridEvaluation;
using plot::fixedText;
using plot::percentText;

plot::TextTable tableOf(const GridEvaluation& evaluation) {
  const auto& error = evaluation.error;
  const auto& precision = evaluation.precision;
  const auto ratio = [](std::size_t part, std::size_t whole) {
    return whole == 0
               ? std::string("-")
               : fixedText(100.0 * static_cast<double>(part) / static_cast<double>(whole), 2) +
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
          {"called occupied, truth unknown: excluded", std::to_string(precision.unknown), ""},
          {"called occupied where people or moving objects were: excluded",
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

plot::TextTable tableOf(const DenseEvaluation& evaluation) {
  const auto& error = evaluation.error;
  const auto& sizes = evaluation.sizes;
  plot::TextTable table = {
      {"dense map", "figure"},
      {"points", std::to_string(error.points)},
      {"median distance to the true surface [m]", fixedText(error.median_m, 4)},
      {"median bar: half a voxel, or half the depth error [m]", fixedText(error.median_bar_m, 4)},
      {"points within their bar [%]", percentText(error.withinBarRatio(), 1)},
      {"points more than 5 voxels from any surface", std::to_string(error.astray)},
      {"points where only moving objects were", std::to_string(error.of_movers)},
      {"of all points [%]", percentText(error.moverRatio(), 3)},
      {"points on objects that never move, not compared", std::to_string(error.on_still_objects)},
      {"voxels of surface in 3 frames within reach", std::to_string(error.coverage.surface)},
      {"of these, covered within a voxel [%]", percentText(error.coverage.ratio(), 1)},
      {"of these, covered within the bar [%]", percentText(error.coverage.ratioWithinBar(), 1)}};
  for (std::size_t i = 0; i < error.by_range.size(); ++i) {
    const auto limits = evaluation.rangeLimits(i);
    table.push_back({"of those seen from " + fixedText(limits[0], 1) + " to " +
                         fixedText(limits[1], 1) + " m at the nearest [%]",
                     percentText(error.by_range[i].ratio(), 1)});
  }
  if (evaluation.is_matched) {
    table.push_back({"of the surface, with stereo depth in 3 frames [%]",
                     percentText(error.coverage.matchableRatio(), 1)});
    table.push_back({"of these, covered [%]", percentText(error.coverage.matchableCovered(), 1)});
  }
  table.push_back(
      {"points, scans [MB]", fixedText(sizes.points_mb, 1) + ", " + fixedText(sizes.scans_mb, 1)});
  table.push_back({"both per kilometre [MB]", fixedText(sizes.perKilometre(), 1)});
  return table;
}

}  // namespace

int runGrid(int argc, const char** argv) {
  std::string truth, estimate;
  eval::ObstacleHeights heights{0.0, 0.0, 0.0};  // 0: as in the replay
  Outputs outputs;
  program::CommandLine line(
      "headway-eval grid",
      "Compares the occupancy grid of a replay with the simulated world it was recorded in.");
  line.option(truth, 0, "truth", "NAME.truth",
              "Truth folder written by headway-sim --depth --masks", true);
  line.option(estimate, 0, "estimate", "OUTDIR",
              "Folder of the replay, with map_grid.gridmap.gz and calibration.yaml", true);
  line.option(heights.min_m, 0, "lowest-obstacle", "M",
              "Minimum height of an obstacle [m]; default: that of the replay");
  line.option(heights.max_m, 0, "highest-obstacle", "M",
              "Maximum height of an obstacle above the ground [m]; default: that of the replay");
  if (!outputs.parse(line, argc, argv, {&truth, &estimate})) return program::kDone;
  const auto result = eval::evaluateGrid(truth, estimate, heights);
  if (!outputs.quiet()) plot::writeTable(std::cout, tableOf(result));
  outputs.write([&] { return toJson(result); },
                [&] { return eval::gridPlot(result.truth, result.estimate, result.swept); });
  return program::kDone;
}

int runDense(int argc, const char** argv) {
  std::string truth, estimate, rawlog;
  Outputs outputs;
  program::CommandLine line(
      "headway-eval dense",
      "Compares the dense map of a replay with the surfaces of the simulated world that it was "
      "recorded in.");
  line.option(truth, 0, "truth", "NAME.truth",
              "Truth folder written by headway-sim --depth --masks", true);
  line.option(estimate, 0, "estimate", "OUTDIR",
              "Folder of the replay of the whole rawlog, with map_dense.ply and map.headway", true);
  line.option(rawlog, 0, "rawlog", "NAME.rawlog",
              "Also match its stereo pairs, to tell how much of the surface they give depth of");
  if (!outputs.parse(line, argc, argv, {&truth, &estimate, &rawlog})) return program::kDone;
  const auto result = eval::evaluateDense(truth, estimate, rawlog);
  if (!outputs.quiet()) plot::writeTable(std::cout, tableOf(result));
  outputs.write([&] { return toJson(result); },
                [&] { return eval::densePlot(result.patches, result.points, result.error); });
  return program::kDone;
}

}  // namespace headway::app
