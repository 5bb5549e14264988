// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/eval/labelled_frames.h>
#include <headway/eval/prediction_error.h>
#include <headway/objects/objects_params.h>

#include <string>
#include <utility>
#include <vector>

#include "suite_worlds.h"

namespace headway::app {

/// Predictor name -> its accumulated errors.
using PredictorEvaluators = std::vector<std::pair<std::string, eval::PredictionEvaluator>>;

/// Output of object tracking on one recording, or on several together, with the truth.
struct ObjectFigures {
  std::vector<eval::LabelledSequence> raw;     ///< detections and truth
  std::vector<eval::LabelledSequence> tracks;  ///< tracks and truth
  PredictorEvaluators on_tracks;               ///< predictions of headway's tracks
  PredictorEvaluators on_truth;                ///< predictions from exact histories
};

/// Runs object tracking once: detections, tracks and truth, without predictions.
[[nodiscard]] ObjectFigures runTracks(const ObjectRecording& recording,
                                      const objects::ObjectsParams& params);

/// Runs object tracking with every predictor.
[[nodiscard]] ObjectFigures runObjects(const ObjectRecording& recording,
                                       const objects::ObjectsParams& params);

/// Appends the recordings of another set.
void add(const ObjectFigures& other, ObjectFigures& together);

}  // namespace headway::app
