// SPDX-License-Identifier: BSD-3-Clause
// Object tracking on the recordings of the suite, and the tables of all errors.
#pragma once

#include <headway/eval/labelled_frames.h>
#include <headway/eval/prediction_error.h>
#include <headway/eval/track_error.h>
#include <headway/objects/objects_params.h>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>
#include <optional>
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

/// Values of slam.dynamic_rejection.
struct Rejection {
  std::string name;
  slam::DynamicRejection value;
};
[[nodiscard]] const std::vector<Rejection>& rejections();

/// Camera error in one world with one kind of rejection.
struct CameraFigures {
  std::size_t frames = 0;
  std::size_t wanted = 0;  ///< greater than `frames` if the world's path ended early
  std::size_t lost = 0;
  std::optional<eval::TrajectoryError> error;
};

/// Predictor name -> its errors.
using PredictorErrors = std::vector<std::pair<std::string, eval::PredictionErrors>>;

/// Object errors on one recording, or on several together.
struct ObjectErrors {
  eval::TrackErrors raw;
  eval::TrackErrors tracks;
  PredictorErrors on_tracks;
  PredictorErrors on_truth;
};
[[nodiscard]] ObjectErrors evaluateObjects(const ObjectFigures& figures);

/// Results of the suite on one recording, or on several together.
struct SuiteEntry {
  std::string name;
  std::vector<std::pair<std::string, CameraFigures>> camera;  ///< by rejection; empty: no images
  std::optional<ObjectErrors> objects;                        ///< none if interrupted
  bool in_plot = true;
  bool is_group = false;  ///< several recordings, evaluated as one set
};

/// All tables with their headings, as Markdown.
void writeSuite(std::ostream& out, const std::vector<SuiteEntry>& entries);

[[nodiscard]] nlohmann::ordered_json suiteFigures(const std::vector<SuiteEntry>& entries);
[[nodiscard]] cv::Mat suitePlot(const std::vector<SuiteEntry>& entries);

}  // namespace headway::app
