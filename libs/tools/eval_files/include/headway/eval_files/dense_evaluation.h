// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/eval/dense_error.h>

#include <array>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace headway::eval_files {

/// Sizes of a dense map [MB].
struct DenseSizes {
  double points_mb = 0.0;  ///< of map_dense.ply
  double scans_mb = 0.0;   ///< of the depth scans in map.headway, uncompressed
  double path_km = 0.0;    ///< that they are of

  [[nodiscard]] std::optional<double> perKilometre() const;  ///< both; nullopt without a path
};

/// Errors of a replay's dense map, with what was compared.
struct DenseEvaluation {
  std::vector<eval::TrueSurface::Patch> patches;  ///< the true surface
  std::vector<Eigen::Vector3d> points;            ///< of map_dense.ply [m]
  eval::DenseError error;
  DenseSizes sizes;
  double voxel_m = 0.0;
  double reach_m = 0.0;     ///< that the replay claims
  bool is_matched = false;  ///< the pairs of the rawlog were matched

  /// Least depths of the surface in one of DenseError's ranges [m].
  [[nodiscard]] std::array<double, 2> rangeLimits(std::size_t range) const;
};

/// Evaluates a replay of a whole simulated rawlog as `headway-eval dense` does.
///
/// @param truth   folder written by headway-sim --depth --masks
/// @param replay  with map_dense.ply, map.headway, replay.json and calibration.yaml
/// @param rawlog  of that truth, to match its pairs as the replay did; empty: not matched
/// @throws InputError if a file is missing, damaged or does not match the others
[[nodiscard]] DenseEvaluation evaluateDense(const std::filesystem::path& truth,
                                            const std::filesystem::path& replay,
                                            const std::string& rawlog);

/// The figures of `headway-eval dense --json`.
[[nodiscard]] nlohmann::ordered_json toJson(const DenseEvaluation& evaluation);

}  // namespace headway::eval_files
