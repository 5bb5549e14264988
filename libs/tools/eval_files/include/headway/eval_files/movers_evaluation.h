// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/eval/moving_object_error.h>
#include <headway/eval/object_motion_error.h>

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace headway::eval_files {

/// Which moving objects a replay found, and how well it knew their motion.
struct MoverEvaluation {
  eval::MovingObjectInput input;  ///< what was compared
  eval::MovingObjectError error;  ///< of confirmed rows
  eval::MovingObjectError with_coasting;
  eval::LabelledObjectError labelled;
  eval::ObjectMotionErrors motion;           ///< by the poses in tracks.csv
  eval::ObjectMotionErrors motion_velocity;  ///< by the velocities in tracks.csv
  eval::ObjectMotionErrors motion_smoothed;  ///< by the poses in tracks_smoothed.csv
};

/// Evaluates a replay as `headway-eval movers` does.
///
/// @param labels  KITTI tracking labels
/// @param poses   true pose of every frame: KITTI (camera), TUM (robot), or a rawlog with
/// truth_pose
/// @param replay  output folder of headway-replay
/// @throws InputError naming the file that cannot be read or does not match the others
[[nodiscard]] MoverEvaluation evaluateMovers(const std::string& labels, const std::string& poses,
                                             const std::string& replay);

/// The figures of `headway-eval movers --json`.
[[nodiscard]] nlohmann::ordered_json toJson(const MoverEvaluation& evaluation);

}  // namespace headway::eval_files
