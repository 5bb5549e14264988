// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/eval/prediction_cases.h>

#include <string>
#include <vector>

namespace headway::eval_files {

/// One recording to evaluate predictions on.
struct PredictionSequence {
  std::string name;
  std::vector<Stamped<Pose>> T_map_cam;  ///< camera pose at each frame
  std::vector<eval::TrueObject> objects;
  std::vector<eval::TrackPrediction> predictions;  ///< empty if predictors are evaluated
  double frame_interval_s = 0.1;
};

/// Input files, or folders whose files are paired by name.
struct PredictionFiles {
  std::string labels;
  std::string poses;      ///< KITTI: camera in the first camera; TUM: robot in map
  std::string estimate;   ///< predictions.csv; empty if predictors are evaluated
  std::string extrinsic;  ///< calibration.yaml with T_robot_cam; empty: robot axes at the camera
};

/// Reads all recordings.
///
/// KITTI poses have no times: frame times are those of the predictions, or 0.1 s apart.
///
/// @throws InputError naming the file that cannot be read or does not match the others
[[nodiscard]] std::vector<PredictionSequence> readPredictionInput(const PredictionFiles& files);

}  // namespace headway::eval_files
