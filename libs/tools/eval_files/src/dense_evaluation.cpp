// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/eval_files/dense_evaluation.h>
#include <headway/map/map_file.h>
#include <headway/report/map_files.h>

#include <nlohmann/json.hpp>

#include "dense_truth.h"

namespace headway::eval_files {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kMega = 1e6;

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

DenseSizes sizesOf(const fs::path& replay, double path_m) {
  DenseSizes sizes;
  sizes.points_mb = static_cast<double>(fs::file_size(replay / "map_dense.ply")) / kMega;
  const auto stored = map::loadMap((replay / "map.headway").string());
  const auto scans = stored.attachments.find(map::kDenseAttachment);
  if (scans != stored.attachments.end()) {
    sizes.scans_mb = static_cast<double>(scans->second.size()) / kMega;
  }
  sizes.path_km = path_m / 1000.0;
  return sizes;
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

}  // namespace

std::optional<double> DenseSizes::perKilometre() const {
  if (!(path_km > 0.0)) return std::nullopt;
  return (points_mb + scans_mb) / path_km;
}

std::array<double, 2> DenseEvaluation::rangeLimits(std::size_t range) const {
  const double width = reach_m / static_cast<double>(eval::DenseError::kRanges);
  return {width * static_cast<double>(range), width * static_cast<double>(range + 1)};
}

DenseEvaluation evaluateDense(const fs::path& truth, const fs::path& replay,
                              const std::string& rawlog) {
  DenseEvaluation result;
  result.points = pointsOf(replay / "map_dense.ply");
  const auto claim = denseClaim(replay);
  auto surface = denseTruth(truth, rawlog, claim);
  result.voxel_m = claim.rig.dense_voxel_m;
  result.reach_m = claim.rig.dense_to_m;
  result.is_matched = !rawlog.empty();
  const double sigma = claim.rig.sigma_disparity_px / claim.rig.focal_baseline;
  result.error = eval::denseError(surface.patches, result.voxel_m, result.reach_m, sigma,
                                  result.points, surface.objects);
  result.sizes = sizesOf(replay, surface.path_m);
  result.patches = std::move(surface.patches);
  return result;
}

Json toJson(const DenseEvaluation& evaluation) {
  const auto& error = evaluation.error;
  const auto& sizes = evaluation.sizes;
  Json by_range = Json::array();
  for (std::size_t i = 0; i < error.by_range.size(); ++i) {
    Json range = coverageJson(error.by_range[i], evaluation.is_matched);
    range["nearest_m"] = evaluation.rangeLimits(i);
    by_range.push_back(std::move(range));
  }
  return {{"voxel_m", evaluation.voxel_m},
          {"reach_m", evaluation.reach_m},
          {"points", error.points},
          {"compared", error.compared},
          {"median_m", error.median_m},
          {"median_bar_m", error.median_bar_m},
          {"within_bar_ratio", optional(error.withinBarRatio())},
          {"astray", error.astray},
          {"of_movers", error.of_movers},
          {"mover_ratio", optional(error.moverRatio())},
          {"on_still_objects", error.on_still_objects},
          {"coverage", coverageJson(error.coverage, evaluation.is_matched)},
          {"by_range", std::move(by_range)},
          {"path_km", sizes.path_km},
          {"points_mb", sizes.points_mb},
          {"scans_mb", sizes.scans_mb},
          {"mb_per_km", optional(sizes.perKilometre())}};
}

}  // namespace headway::eval_files
