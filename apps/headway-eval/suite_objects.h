#pragma once

#include <headway/eval/prediction_error.h>
#include <headway/eval/track_error.h>
#include <headway/objects/objects_params.h>

#include <string>
#include <utility>
#include <vector>

#include "suite_worlds.h"

namespace headway::app {

/// What the moving-object layer made of one recording.
struct ObjectFigures {
  eval::TrackErrors raw;     ///< positions of the detections
  eval::TrackErrors tracks;  ///< ours
  /// Predictor -> errors of its predictions, on the layer's own tracks.
  std::vector<std::pair<std::string, eval::PredictionErrors>> on_tracks;
  /// Predictor -> errors on exact histories.
  std::vector<std::pair<std::string, eval::PredictionErrors>> on_truth;
};

/// Runs the moving-object layer with every predictor and judges what came out.
[[nodiscard]] ObjectFigures judgeObjects(const ObjectRecording& recording,
                                         const objects::ObjectsParams& params);

}  // namespace headway::app
