// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/eval/dense_error.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/rig_capability.h>

#include <filesystem>
#include <string>
#include <vector>

namespace headway::eval_files {

/// What a dense map is compared with.
struct DenseTruth {
  std::vector<eval::TrueSurface::Patch> patches;
  std::vector<eval::ObjectBox> objects;
  double path_m = 0.0;  ///< length of the robot's path
};

/// How a replay made its dense map.
struct DenseClaim {
  StereoCamera camera;
  stereo::RigCapability rig;  ///< with what was configured
  stereo::DisparityParams disparity;
};

/// Reads calibration.yaml and replay.json of a replay's folder.
///
/// @throws InputError if one is missing or damaged
[[nodiscard]] DenseClaim denseClaim(const std::filesystem::path& replay);

/// The true static surface and the true objects of a simulated rawlog.
///
/// @param folder  NAME.truth with depth/, masks/, trajectory.tum and objects.csv
/// @param rawlog  of that truth, to match its pairs as the replay did; empty: not matched
/// @throws InputError if a file is missing or its size differs from the camera's
[[nodiscard]] DenseTruth denseTruth(const std::filesystem::path& folder, const std::string& rawlog,
                                    const DenseClaim& claim);

}  // namespace headway::eval_files
