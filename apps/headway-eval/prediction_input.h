#pragma once

#include <headway/eval/prediction_cases.h>

#include <string>
#include <vector>

namespace headway::app {

/// One recording whose predictions are judged.
struct PredictionSequence {
  std::string name;
  std::vector<Stamped<Pose>> T_map_cam;  ///< of each frame
  std::vector<eval::TrueObject> objects;
  std::vector<eval::TrackPrediction> predictions;  ///< empty where predictors are judged
  double frame_interval_s = 0.1;
};

/// Where labels and predictions of several recordings lie: files, or folders paired by name.
struct PredictionFiles {
  std::string labels;
  std::string poses;      ///< KITTI: camera in the first camera; TUM: robot in map
  std::string estimate;   ///< predictions.csv; empty where predictors are judged
  std::string extrinsic;  ///< calibration.yaml with T_robot_cam; empty: axes turned, no offset
};

/// Reads all recordings.
///
/// KITTI poses have no times: frames are 0.1 s apart, or as the predictions say.
///
/// @throws InputError naming the file for what cannot be read or does not fit together
[[nodiscard]] std::vector<PredictionSequence> readPredictionInput(const PredictionFiles& files);

}  // namespace headway::app
