// SPDX-License-Identifier: BSD-3-Clause
#include <headway/eval/dense_error.h>
#include <headway/eval/plots.h>
#include <headway/plot/text_table.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"

namespace headway::app {
namespace {

using eval::DenseEvaluation;

struct DenseOptions {
  std::string truth;
  std::string estimate;
  std::string rawlog;
  bool quiet = false;
  Outputs outputs;
};

bool parseDense(DenseOptions& options, int argc, const char** argv) {
  program::CommandLine line(
      "headway-eval dense",
      "Compares the dense map of a replay with the surfaces of the simulated world that it was "
      "recorded in.");
  line.option(options.truth, 0, "truth", "NAME.truth",
              "Truth folder written by headway-sim --depth --masks", true);
  line.option(options.estimate, 0, "estimate", "OUTDIR",
              "Folder of the replay of the whole rawlog, with map_dense.ply and map.headway", true);
  line.option(options.rawlog, 0, "rawlog", "NAME.rawlog",
              "Also match its stereo pairs, to tell how much of the surface they give depth of");
  options.outputs.describe(line);
  if (!line.parse(argc, argv)) return false;
  options.quiet = line.quiet();
  options.outputs.requireWritable({options.truth, options.estimate, options.rawlog});
  return true;
}

plot::TextTable tableOf(const DenseEvaluation& evaluation) {
  const auto& error = evaluation.error;
  const auto& sizes = evaluation.sizes;
  using plot::fixedText;
  using plot::percentText;
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

int runDense(int argc, const char** argv) {
  DenseOptions options;
  if (!parseDense(options, argc, argv)) return program::kDone;
  const auto result = eval::evaluateDense(options.truth, options.estimate, options.rawlog);
  if (!options.quiet) plot::writeTable(std::cout, tableOf(result));
  options.outputs.write(
      [&] { return toJson(result); },
      [&] { return eval::densePlot(result.patches, result.points, result.error); });
  return program::kDone;
}

}  // namespace headway::app
