// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/eval/plots.h>
#include <headway/map/map_file.h>
#include <headway/plot/text_table.h>
#include <headway/report/map_files.h>

#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "dense_truth.h"

namespace headway::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kMega = 1e6;

struct DenseOptions {
  std::string truth;
  std::string estimate;
  std::string rawlog;
  bool quiet = false;
  Outputs outputs;
};

/// Sizes of a dense map [MB].
struct Sizes {
  double points_mb = 0.0;  ///< of map_dense.ply
  double scans_mb = 0.0;   ///< of the depth scans in map.headway, uncompressed
  double path_km = 0.0;    ///< that they are of

  [[nodiscard]] double total() const { return points_mb + scans_mb; }
  [[nodiscard]] std::optional<double> perKilometre() const {
    if (!(path_km > 0.0)) return std::nullopt;
    return total() / path_km;
  }
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

std::vector<Eigen::Vector3d> pointsOf(const fs::path& path) {
  if (!fs::exists(path)) {
    throw InputError(path.string() + ": no such file; has the replay a dense map (dense.use)?");
  }
  std::vector<Eigen::Vector3d> points;
  for (const auto& point : report::readPoints(path, 0)) {
    points.push_back(point.position.cast<double>());
  }
  return points;
}

Sizes sizesOf(const fs::path& replay, double path_m) {
  Sizes sizes;
  sizes.points_mb = static_cast<double>(fs::file_size(replay / "map_dense.ply")) / kMega;
  const auto stored = map::loadMap((replay / "map.headway").string());
  const auto scans = stored.attachments.find(map::kDenseAttachment);
  if (scans != stored.attachments.end()) {
    sizes.scans_mb = static_cast<double>(scans->second.size()) / kMega;
  }
  sizes.path_km = path_m / 1000.0;
  return sizes;
}

/// Least depths of the surface in one of the ranges [m].
std::array<double, 2> rangeLimits(std::size_t range, double reach_m) {
  const double width = reach_m / static_cast<double>(eval::DenseError::kRanges);
  return {width * static_cast<double>(range), width * static_cast<double>(range + 1)};
}

plot::TextTable tableOf(const eval::DenseError& error, const Sizes& sizes, double reach_m,
                        bool matched) {
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
    const auto limits = rangeLimits(i, reach_m);
    table.push_back({"of those seen from " + fixedText(limits[0], 1) + " to " +
                         fixedText(limits[1], 1) + " m at the nearest [%]",
                     percentText(error.by_range[i].ratio(), 1)});
  }
  if (matched) {
    table.push_back({"of the surface, with stereo depth in 3 frames [%]",
                     percentText(error.coverage.matchableRatio(), 1)});
    table.push_back({"of these, covered [%]", percentText(error.coverage.matchableCovered(), 1)});
  }
  table.push_back(
      {"points, scans [MB]", fixedText(sizes.points_mb, 1) + ", " + fixedText(sizes.scans_mb, 1)});
  table.push_back({"both per kilometre [MB]", fixedText(sizes.perKilometre(), 1)});
  return table;
}

Json optional(std::optional<double> value) { return value ? Json(*value) : Json(); }

Json coverageJson(const eval::Coverage& coverage, bool matched) {
  Json json = {{"surface", coverage.surface},
               {"covered", coverage.covered},
               {"ratio", optional(coverage.ratio())},
               {"ratio_within_bar", optional(coverage.ratioWithinBar())}};
  if (!matched) return json;
  json["matchable"] = coverage.matchable;
  json["matchable_ratio"] = optional(coverage.matchableRatio());
  json["matchable_covered_ratio"] = optional(coverage.matchableCovered());
  return json;
}

Json jsonOf(const eval::DenseError& error, const Sizes& sizes, const stereo::RigCapability& rig,
            bool matched) {
  Json by_range = Json::array();
  for (std::size_t i = 0; i < error.by_range.size(); ++i) {
    Json range = coverageJson(error.by_range[i], matched);
    range["nearest_m"] = rangeLimits(i, rig.dense_to_m);
    by_range.push_back(std::move(range));
  }
  return {{"voxel_m", rig.dense_voxel_m},
          {"reach_m", rig.dense_to_m},
          {"points", error.points},
          {"compared", error.compared},
          {"median_m", error.median_m},
          {"median_bar_m", error.median_bar_m},
          {"within_bar_ratio", optional(error.withinBarRatio())},
          {"astray", error.astray},
          {"of_movers", error.of_movers},
          {"mover_ratio", optional(error.moverRatio())},
          {"on_still_objects", error.on_still_objects},
          {"coverage", coverageJson(error.coverage, matched)},
          {"by_range", std::move(by_range)},
          {"path_km", sizes.path_km},
          {"points_mb", sizes.points_mb},
          {"scans_mb", sizes.scans_mb},
          {"mb_per_km", optional(sizes.perKilometre())}};
}

}  // namespace

int runDense(int argc, const char** argv) {
  DenseOptions options;
  if (!parseDense(options, argc, argv)) return program::kDone;
  const fs::path replay(options.estimate);
  const auto points = pointsOf(replay / "map_dense.ply");
  const auto claim = denseClaim(replay);
  const auto truth = denseTruth(options.truth, options.rawlog, claim);
  const double sigma = claim.rig.sigma_disparity_px / claim.rig.focal_baseline;
  const auto error = eval::denseError(truth.patches, claim.rig.dense_voxel_m, claim.rig.dense_to_m,
                                      sigma, points, truth.objects);
  const Sizes sizes = sizesOf(replay, truth.path_m);
  const bool matched = !options.rawlog.empty();
  if (!options.quiet) {
    plot::writeTable(std::cout, tableOf(error, sizes, claim.rig.dense_to_m, matched));
  }
  options.outputs.write([&] { return jsonOf(error, sizes, claim.rig, matched); },
                        [&] { return eval::densePlot(truth.patches, points, error); });
  return program::kDone;
}

}  // namespace headway::app
