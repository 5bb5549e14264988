#pragma once

#include <headway/eval/labelled_frames.h>
#include <headway/eval/prediction_error.h>
#include <headway/objects/objects_params.h>

#include <string>
#include <utility>
#include <vector>

#include "suite_worlds.h"

namespace headway::app {

/// Predictor -> its predictions beside what happened.
using PredictorJudges = std::vector<std::pair<std::string, eval::PredictionJudge>>;

/// What the moving-object layer made of one recording, or of several together.
struct ObjectFigures {
  std::vector<eval::LabelledSequence> raw;     ///< detections beside the truth
  std::vector<eval::LabelledSequence> tracks;  ///< ours beside the truth
  PredictorJudges on_tracks;                   ///< predictions of the layer's own tracks
  PredictorJudges on_truth;                    ///< predictions from exact histories
};

/// Runs the moving-object layer once: detections and tracks beside the truth, no predictions.
[[nodiscard]] ObjectFigures runTracks(const ObjectRecording& recording,
                                      const objects::ObjectsParams& params);

/// Runs the moving-object layer with every predictor.
[[nodiscard]] ObjectFigures runObjects(const ObjectRecording& recording,
                                       const objects::ObjectsParams& params);

/// Adds the recordings of another one, to be judged as one set.
void add(const ObjectFigures& other, ObjectFigures& together);

}  // namespace headway::app
